// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "daemon/common/assignment/assignment.h"
#include "daemon/common/base/scratch.h"
#include "daemon/common/models/measurement_model.h"
#include "daemon/local/tracking/candidates.h"
#include "daemon/local/tracking/detectability.h"
#include "daemon/local/tracking/existence.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// Whether a hit is independent proof of a vehicle: radars and cameras see the same ghosts again
/// and again.
enum class Proof { kIndependent, kRepeated };

/// Which measurement of one frame belongs to which track: likelihood ratios of the pairs inside the
/// chi-square gate, exact assignment per connected group, and each track's existence from the
/// marginals of all assignments. With likelihood l of the measurement under the track, probability
/// of detection p, existence r and the density c of clutter and births there, a pair weighs
///
///     ratio = r p l / c
///
/// A frame: Begin, fill candidates(), Compare (or AddPair) for near pairs, Solve; then ask. Index i
/// is the track's in the table, j the measurement's in the frame. Nothing outlasts a frame but the
/// times of FrameDetectability.
class Association {
 public:
  explicit Association(const TrackerConfig& config);

  /// A frame of `sensor` at table.now(): asks how likely it is to show each track.
  void Begin(SensorKey sensor, const DetectabilityOf& detectability, TrackTable& table);

  [[nodiscard]] Candidates& candidates() { return candidates_; }
  [[nodiscard]] const Candidates& candidates() const { return candidates_; }
  /// What this frame ought to show of each track.
  [[nodiscard]] const FrameDetectability& expected() const { return expected_; }
  /// Half width of the gate of a measurement with so many rows, in standard deviations.
  [[nodiscard]] double GateSigmas(std::size_t rows) const { return std::sqrt(gate_[rows]); }

  /// Adds the pair if the measurement, as what the sensor can see of this track, lies in its gate.
  template <class Look, class Measurement>
  void Compare(const TrackTable& table, std::size_t i, std::size_t j, const Look& look,
               const Measurement& z);
  /// @param log_cells ln of how much larger the measurement's own space is than the one that
  /// `likelihood` compares it in.
  void AddPair(const LocalTrack& track, std::size_t i, std::size_t j, const Likelihood& likelihood,
               double log_cells);

  /// Assigns, and sets the existence of every track.
  void Solve(std::size_t measurements, Proof proof, TrackTable& table);

  /// What track i was given; nullopt: nothing.
  [[nodiscard]] std::optional<std::size_t> GivenTo(std::size_t i) const {
    if (assigned_[i] < 0) return std::nullopt;
    return static_cast<std::size_t>(assigned_[i]);
  }
  /// Of a track that measurement j starts: none of those that there are explains it.
  [[nodiscard]] double BirthExistence(std::size_t j) const {
    return candidates_[j].birth_existence * (1.0 - marginals_.explained()[j]);
  }

 private:
  FrameDetectability expected_;
  std::array<double, Linearized::kMaxRows + 1> gate_{};  // Squared distance, by rows.
  Scratch<Candidates> candidates_;
  Scratch<std::vector<SparsePair>> costs_;
  Scratch<std::vector<GatedPair>> pairs_;
  Scratch<std::vector<double>> lone_;
  Scratch<std::vector<int>> assigned_;
  Scratch<ClusteredAssignmentSolver> solver_;
  Scratch<AssociationMarginals> marginals_;
};

/// Size of the space that clutter of a kind spreads over. That of a box has as many dimensions as
/// it has usable edges; radar measurements differ in none.
double Cells(const CameraMeasurement& z, const CameraLook& look);
inline double Cells(const RadarMeasurement&, const RadarLook&) { return 1.0; }

template <class Look, class Measurement>
void Association::Compare(const TrackTable& table, std::size_t i, std::size_t j, const Look& look,
                          const Measurement& z) {
  const Measurement given = expected_.Given(i, table, z);
  const auto [track, evidence] = table[i];
  const auto likelihood = evidence.filter.Evaluate(look, given, table.settings());
  if (!likelihood) return;
  AddPair(track, i, j, *likelihood, std::log(Cells(z, look) / Cells(given, look)));
}

}  // namespace v2vouch
