// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "daemon/common/assignment/assignment.h"

namespace v2vouch {

/// Existence after a frame that did not detect the vehicle: r (1 - p) / (1 - r p).
double ExistenceAfterMiss(double existence, double detection_probability);

/// Existence of a track that one measurement starts, where newcomers and clutter are to be expected
/// with these densities. A new track is never nearly certain, and never so unlikely that it cannot
/// be confirmed: it lies in [kMinBirth, 0.3].
double BirthExistence(double births, double clutter);
inline constexpr double kMinBirth = 1e-4;

/// A track and a measurement that may belong together. `ratio` is the likelihood of the measurement
/// under the track, times r p, over the density of clutter and births there.
struct GatedPair {
  int track = 0;
  int measurement = 0;
  double ratio = 0.0;
};

/// Probability of each association event, per gated cluster: exact sum over all matchings where a
/// cluster has at most four tracks and four measurements, else the best assignment against its own
/// absence. A track that misses weighs 1 - r p.
///
///     P(matching) ~ prod over missed tracks (1 - r_i p_i)  prod over pairs ratio_ij
///
/// Williams (2015), "Marginal multi-Bernoulli filters": the marginals a PMB filter needs.
class AssociationMarginals {
 public:
  /// @param missed per track 1 - r p.
  /// @param assigned per track the best assignment's measurement, or -1.
  void Compute(std::span<const GatedPair> pairs, std::span<const double> missed,
               std::span<const int> assigned, std::size_t measurements);

  /// Probability that the track was detected by any measurement.
  [[nodiscard]] std::span<const double> detected() const { return detected_; }
  /// Probability that the measurement came from any track.
  [[nodiscard]] std::span<const double> explained() const { return explained_; }

 private:
  int Root(int node);

  std::vector<double> detected_, explained_;
  std::vector<int> parent_, order_;
};

}  // namespace v2vouch
