// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace v2vouch {

/// Allowed range of a configuration value. A config struct lists its fields once:
///
///     template <class Archive> void Visit(Archive& a) {
///       a.Field("eps_m", eps_m, {.above = 0.0, .at_most = 10.0});
///     }
///
/// and that list serves reading, checking and printing. Nested structs and vectors of structs go
/// through the same Field; the archive tells them apart. Keys ending in `_deg` are radians inside:
/// a.Degrees("yaw_deg", yaw_rad, {bounds in degrees}). Enumerations: a.Choice("source", value,
/// {{"boxes", kBoxes}, ...}).
struct Bounds {
  std::optional<double> above{};     ///< Exclusive lower bound.
  std::optional<double> at_least{};  ///< Inclusive lower bound.
  std::optional<double> below{};     ///< Exclusive upper bound.
  std::optional<double> at_most{};   ///< Inclusive upper bound.
};

}  // namespace v2vouch
