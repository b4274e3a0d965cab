// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>

#include "daemon/local/tracking/tracker.h"

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
  static void Vote(const PoseMeasurement&, const auto&) {}
};

template <>
struct WholeTraits<BoxMeasurement> {
  static constexpr std::size_t kGateRows = 2;
  static bool IsPoint(const TrackFilter& filter) { return !filter.is_vehicle(); }
  static TrackFilter Start(const BoxMeasurement& z) { return TrackFilter::FromBox(z); }
  static void Vote(const BoxMeasurement& z, const auto& vote) { vote(z.object_class, z.score); }
};

template <class Measurement>
void Tracker::UpdateWhole(const WholeFrame& frame, std::span<const Measurement> measurements,
                          const DetectabilityOf& detectability) {
  using Traits = WholeTraits<Measurement>;
  updates_.clear();
  pose_updates_.clear();
  costs_.clear();
  pairs_.clear();
  AskDetectability(frame.sensor, detectability);
  const double sigmas = std::sqrt(gate_[Traits::kGateRows]);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const TrackFilter& filter = hidden_[i].filter;
    double reach_m = sigmas * LargestSigma(filter.position_covariance());
    if (Traits::IsPoint(filter)) reach_m += tracks_[i].extent.length_m;
    candidates_.ForEachNear(filter.position_O(), reach_m, [&](std::size_t j) {
      if (!candidates_[j].may_start) return;
      if (const auto likelihood = filter.Evaluate(measurements[j], settings_)) {
        AddPair(i, j, *likelihood, filter.knows_direction() ? 0.0 : frame.log_point_cells);
      }
    });
  }
  Associate(measurements.size(), Proof::kIndependent);

  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    // Whatever other sensors made likely, a frame of whole vehicles judges it.
    double& proven = hidden_[i].proven;
    proven = assigned_[i] < 0 ? ExistenceAfterMiss(proven, missing_[i])
                              : std::max(proven, tracks_[i].existence);
    if (assigned_[i] >= 0)
      TakeWhole(frame, i, measurements[static_cast<std::size_t>(assigned_[i])]);
  }
  StartWhole(frame, measurements);
  Conclude(since_update_s_);
}

template <class Measurement>
void Tracker::TakeWhole(const WholeFrame& frame, std::size_t track, const Measurement& raw) {
  const auto j = static_cast<std::size_t>(assigned_[track]);
  candidates_[j].may_start = false;
  Measurement z = raw;
  if constexpr (std::is_same_v<Measurement, BoxMeasurement>) {
    if (!frame.is_bench) z = Given(track, raw);
  }
  Hidden& hidden = hidden_[track];
  if (frame.origin_O) hidden.filter.SeenFrom(*frame.origin_O);
  WholeTraits<Measurement>::Vote(
      z, [&](ObjectClass named, double score) { Vote(track, named, score); });
  if (!hidden.filter.Update(z)) {
    failures_.push_back(Reason::kTrackNumerics);
    hidden.is_dead = true;
    return;
  }
  Hit(track, frame.sensor);
  hidden.has_range = true;
  pose_updates_.push_back({tracks_[track].id, j});
  if constexpr (std::is_same_v<Measurement, BoxMeasurement>) {
    if (!frame.is_bench) updates_.push_back({tracks_[track].id, z});
  }
}

template <class Measurement>
void Tracker::StartWhole(const WholeFrame& frame, std::span<const Measurement> measurements) {
  std::size_t started = 0;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (!candidates_[j].may_start) continue;
    if (started == frame.most_newcomers) {
      failures_.push_back(Reason::kTrackTableFull);
      return;
    }
    const double existence = candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]);
    TrackFilter filter = WholeTraits<Measurement>::Start(measurements[j]);
    if (frame.origin_O) filter.SeenFrom(*frame.origin_O);
    if (!Start(filter, frame.sensor, j, existence)) continue;
    ++started;
    const std::size_t track = tracks_.size() - 1;
    hidden_[track].is_certain = frame.is_bench;
    WholeTraits<Measurement>::Vote(
        measurements[j], [&](ObjectClass named, double score) { Vote(track, named, score); });
    pose_updates_.push_back({tracks_[track].id, j});
    if constexpr (std::is_same_v<Measurement, BoxMeasurement>) {
      if (!frame.is_bench) updates_.push_back({tracks_[track].id, measurements[j]});
    }
  }
}

}  // namespace v2vouch
