// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "daemon/local/tracking/tracker.h"

// Private to the tracker's files: frames of boxes and of poses, which tell where a whole vehicle
// is.
namespace v2vouch {

/// How a measurement that tells where a whole vehicle is differs from the other one.
template <class Measurement>
struct WholeTraits;

template <>
struct WholeTraits<PoseMeasurement> {
  /// Rows that the coarse gate is for.
  static constexpr std::size_t kGateRows = LinearizedPose::kRows;
  /// Whether the track is compared as a point: a reflection somewhere on a vehicle.
  static bool IsPoint(const TrackFilter& filter) { return !filter.knows_direction(); }
  static TrackFilter Start(const PoseMeasurement& z) { return TrackFilter::FromPose(z); }
  static PoseMeasurement Given(const FrameDetectability&, std::size_t, const TrackTable&,
                               const PoseMeasurement& z) {
    return z;
  }
  static void NoteClass(const PoseMeasurement&, std::size_t, TrackTable&) {}
};

template <>
struct WholeTraits<BoxMeasurement> {
  static constexpr std::size_t kGateRows = 2;
  static bool IsPoint(const TrackFilter& filter) { return !filter.is_vehicle(); }
  static TrackFilter Start(const BoxMeasurement& z) { return TrackFilter::FromBox(z); }
  /// With what visibility knows, which a bench has no say in.
  static BoxMeasurement Given(const FrameDetectability& expected, std::size_t i,
                              const TrackTable& table, const BoxMeasurement& z) {
    return expected.Given(i, table, z);
  }
  static void NoteClass(const BoxMeasurement& z, std::size_t i, TrackTable& table) {
    table.NoteClass(i, z.object_class, z.score);
  }
};

template <class Measurement>
void Tracker::UpdateWhole(const WholeFrame& frame, std::span<const Measurement> measurements) {
  CompareWhole(frame, measurements);
  association_.Solve(measurements.size(), Proof::kIndependent, table_);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    // Whatever other sensors made likely, a frame of whole vehicles judges it.
    Prove(i);
    if (const auto j = association_.GivenTo(i)) TakeWhole(frame, i, *j, measurements[*j]);
  }
  StartWhole(frame, measurements);
  Conclude();
}

template <class Measurement>
void Tracker::CompareWhole(const WholeFrame& frame, std::span<const Measurement> measurements) {
  using Traits = WholeTraits<Measurement>;
  const Candidates& candidates = association_.candidates();
  const double sigmas = association_.GateSigmas(Traits::kGateRows);
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const LocalTrack& track = table_[i].track;
    const TrackFilter& filter = table_[i].evidence.filter;
    double reach_m = sigmas * LargestSigma(filter.position_covariance());
    if (Traits::IsPoint(filter)) reach_m += track.extent.length_m;
    candidates.ForEachNear(filter.position_O(), reach_m, [&](std::size_t j) {
      if (!candidates[j].may_start) return;
      if (const auto likelihood = filter.Evaluate(measurements[j], table_.settings())) {
        const double log_cells = filter.knows_direction() ? 0.0 : frame.log_point_cells;
        association_.AddPair(track, i, j, *likelihood, log_cells);
      }
    });
  }
}

template <class Measurement>
void Tracker::TakeWhole(const WholeFrame& frame, std::size_t i, std::size_t j,
                        const Measurement& raw) {
  const auto [track, evidence] = table_[i];
  association_.candidates()[j].may_start = false;
  const Measurement z =
      frame.is_bench ? raw
                     : WholeTraits<Measurement>::Given(association_.expected(), i, table_, raw);
  if (frame.origin_O) evidence.filter.SeenFrom(*frame.origin_O);
  WholeTraits<Measurement>::NoteClass(z, i, table_);
  if (!evidence.filter.Update(z)) return table_.Fail(i);
  table_.NoteHit(i, frame.sensor);
  evidence.has_range = true;
  NoteWhole(frame, track.id, j, z);
}

template <class Measurement>
void Tracker::StartWhole(const WholeFrame& frame, std::span<const Measurement> measurements) {
  const std::size_t most = table_.size() + frame.most_newcomers;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (!association_.candidates()[j].may_start) continue;
    if (table_.size() == most) return table_.AddFault(Reason::kTrackTableFull);
    TrackFilter filter = WholeTraits<Measurement>::Start(measurements[j]);
    if (frame.origin_O) filter.SeenFrom(*frame.origin_O);
    if (!table_.Start(filter, frame.sensor, j, association_.BirthExistence(j))) continue;
    const auto [track, evidence] = table_.back();
    evidence.is_certain = frame.is_bench;
    WholeTraits<Measurement>::NoteClass(measurements[j], table_.size() - 1, table_);
    NoteWhole(frame, track.id, j, measurements[j]);
  }
}

template <class Measurement>
void Tracker::NoteWhole(const WholeFrame& frame, std::uint64_t id, std::size_t j,
                        const Measurement& z) {
  pose_updates_.push_back({id, j});
  if constexpr (std::is_same_v<Measurement, BoxMeasurement>) {
    if (!frame.is_bench) updates_.push_back({id, z});
  }
}

}  // namespace v2vouch
