// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// One message as it arrives at the ego's computer.
struct SimEvent {
  Timestamp arrival{};
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// A scenario as a stream of events in order of arrival: SIM_SCENARIO once, then RADAR_*, CAMERA_*,
/// EGO_MOTION, EGO_GNSS, BSM with TRUTH_BSM right behind it, and TRUTH. Sensors with boxes only: a
/// camera's `source` decides between CAMERA_<NAME> and CAMERA_<NAME>_DETECTED.
///
/// The same scenario and seed give the same bytes (per toolchain). Time 0 of the scenario is its
/// start_utc_s; the computer's clock is UTC.
class Simulation {
 public:
  Simulation(const World& world, std::uint64_t seed);
  ~Simulation();

  /// Runs on for one second of the scenario and hands out what has arrived by then.
  /// @return false when the scenario is over; `events` then holds the last ones.
  bool Step(std::vector<SimEvent>& events);

  /// What the user should know of this run: an attack without a vehicle to act on, for instance.
  [[nodiscard]] const std::vector<std::string>& notes() const;

  /// Share of the scenario done, 0..1.
  [[nodiscard]] double progress() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace v2vouch::sim
