// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <v2vouch/bsm_t.hpp>

#include "sim/sensors/ego.h"
#include "sim/sensors/gnss_error.h"
#include "sim/sensors/message.h"
#include "sim/sensors/spells.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// What a sender knows of itself, in SI, before J2735 integers are made of it.
struct SenderState {
  std::int64_t position_utime = 0;  ///< Time of the position, microseconds UTC.
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double elevation_m = 0.0;
  double semi_major_m = 1.0;  ///< NaN = unavailable.
  double speed_mps = 0.0;     ///< Negative in reverse.
  double heading_rad = 0.0;   ///< Clockwise from true north.
  double accel_long_mps2 = 0.0;
  double accel_lat_mps2 = 0.0;
  double yaw_rate_radps = 0.0;  ///< Left positive.
  double length_m = 4.5;
  double width_m = 1.8;
  Brakes brakes = Brakes::kByDeceleration;
};

/// Core data in J2735's integers: rounded to the nearest unit, clamped to the valid range, signs
/// turned where J2735's differ (yaw rate). Everything else in `bsm` is left as it is.
void Quantise(const SenderState& state, bsm_t& bsm);

/// A sender's `number`-th identity, drawn from the seed.
Identity IdentityOf(std::uint64_t seed, std::uint32_t device, int number);

/// How many identities a sender has used up at `time_s`.
int IdentityNumber(const SenderSpec& sender, double time_s);

/// One sender's on-board unit, and the way of its messages to the ego's receiver.
class BsmSender {
 public:
  /// @param actor an index into World::actors(), or -1 for the ego's own echo.
  BsmSender(const World& world, int actor, std::uint64_t seed);

  /// A transmitter carried along 30 m behind the ego, which tells of the ego for want of a vehicle.
  /// @param device kFirstDeviceId or more.
  static BsmSender Device(const World& world, std::uint32_t device, std::uint64_t seed);

  /// Time of the next position this sender will send [s of the scenario].
  [[nodiscard]] double next_time_s() const { return next_time_s_; }

  /// Makes the message of the position at next_time_s() and moves on to the next.
  /// @return nullopt when the vehicle is not there.
  std::optional<Message> NextMessage();

  /// The same as it is received, without `seq`. @return nullopt also when it is lost on its way.
  std::optional<bsm_t> Next();

 private:
  BsmSender(const World& world, int actor, std::uint32_t subject, std::uint64_t seed);
  // What chance decides about one message.
  struct Draws {
    GnssError::Value position;
    double speed_mps, heading_rad;              // Slow errors.
    double speed_noise_mps, heading_noise_rad;  // White.
    double latency_s, luck, fading_db;
  };
  Draws DrawErrors(std::int64_t number, double dt_s);
  void Advance();
  [[nodiscard]] bool is_device() const { return subject_ >= kFirstDeviceId; }

  const World& world_;
  int actor_;
  std::uint32_t subject_;
  SenderSpec sender_;
  std::uint64_t seed_;
  MessageWriter writer_;
  Random errors_;
  GnssError position_;
  GaussMarkov speed_, heading_;
  ErrorBursts bursts_;
  RadioGaps gaps_;
  std::int64_t count_ = 0;  // Messages made ...
  std::int64_t tick_ = 0;   // ... and turns of the clock they were made in; a pair has one.
  bool is_second_ = false;  // Of a pair is the next one.
  int first_msg_count_ = 0;
  double phase_s_ = 0.0;
  double next_time_s_ = 0.0;
  double last_time_s_ = 0.0;
  double held_yaw_rad_ = 0.0;
  bool has_heading_ = false;
};

}  // namespace v2vouch::sim
