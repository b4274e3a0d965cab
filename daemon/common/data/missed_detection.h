// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Negative evidence: what is left of the likelihood that a vehicle is at a position after the
/// sensors have observed it and shown nothing there,
///
///     l (1 - (1 - clear_doubt) P_D) / (1 - false_detection)
///
/// The one answer of the bridge (EmptyPlace) and of claimed positions (ClaimedPlace); how
/// observations are added up differs: a bridge counts in a row, a claim may be biased.
inline double AfterMiss(double likelihood, double detection_probability, double clear_doubt,
                        double false_detection) {
  return likelihood * (1.0 - (1.0 - clear_doubt) * detection_probability) / (1.0 - false_detection);
}

/// Chance that something is seen where nothing is: clutter that happens to lie there. Assumed.
inline constexpr double kFalseDetection = 0.05;
/// Chance that what the visibility map calls clear is covered after all. Assumed; one observation
/// can say no more than a factor of 6 by it.
inline constexpr double kClearDoubt = 0.15;

}  // namespace v2vouch
