// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/warnings/prediction.h"
#include "sim/run_log/truth.h"

namespace v2vouch::evaluation {

/// Who brakes, how late and how hard (notes of the official tests: a planner, a driver).
struct Braking {
  double after_s = 0.2;
  double decel_mps2 = 8.0;
};
inline constexpr Braking kPlanner{0.2, 8.0};
inline constexpr Braking kDriver{1.2, 4.0};

struct Outcome {
  bool has_contact = false;
  Timestamp contact{};             ///< When; 1970 = none.
  double contact_speed_mps = 0.0;  ///< Of the ego, at the contact.
  double speed_lost_mps = 0.0;     ///< Against the true ego, at most.
};

/// The run once more with an ego that goes its true way but brakes from `warned` on to a stop;
/// nullopt: never. The world goes on for 3 s beyond the log at constant turn rate and acceleration.
/// A contact from behind is not the ego's.
Outcome Simulate(const Truth& truth, const warnings::EgoBody& body, std::optional<Timestamp> warned,
                 const Braking& braking);

}  // namespace v2vouch::evaluation
