// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <v2vouch/bsm_t.hpp>
#include <v2vouch/truth_bsm_t.hpp>

#include "sim/world/world.h"

namespace v2vouch::sim {

/// A sender's TemporaryID and certificate digest.
struct Identity {
  std::array<std::uint8_t, 4> id{};
  std::array<std::uint8_t, 8> certificate{};
};

/// What is said of the brakes.
enum class Brakes { kByDeceleration, kOn, kOff };

/// What a unit says of a vehicle, in SI and world frame W, before J2735's integers are made of it.
struct Statement {
  double time_s = 0.0;         ///< Of the scenario: when it was so.
  Vec2 centre = Vec2::Zero();  ///< Of the footprint, the receiver's errors included.
  double height_m = 0.0;       ///< Above the road, the same.
  double yaw_rad = 0.0;        ///< Of the vehicle's front, counter-clockwise from east.
  double speed_mps = 0.0;      ///< Negative in reverse.
  double yaw_rate_radps = 0.0;
  double accel_mps2 = 0.0;
  double accel_lat_mps2 = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  double semi_major_m = 1.0;  ///< NaN = unavailable.
  Brakes brakes = Brakes::kByDeceleration;
};

/// One message on its way to the ego, and what is true behind it.
struct Message {
  double time_s =
      0.0;  ///< When the unit took its turn: what it would honestly have said was so then.
  double stamp_s = 0.0;         ///< The time secMark tells.
  double signed_s = 0.0;        ///< The signature's stamp: this time ...
  double signed_after_s = 0.0;  ///< ... and so long after.
  double latency_s = 0.0;       ///< From time_s to reception.
  Statement said;
  Identity identity;
  int msg_count = 0;
  int signature_state = 1;  ///< As in bsm_t.
  double rssi_dbm = 0.0;
  double loss = 0.0;     ///< Probability that it is lost on its way ...
  bool is_lost = false;  ///< ... and whether it is.

  std::uint32_t device = 0;   ///< Who transmits: the vehicle's id, or above kFirstDeviceId.
  int voice = 0;              ///< Which of this transmitter's identities at a time; 0 = its own.
  std::uint32_t vehicle = 0;  ///< It speaks for; 0 = there is none.
  Vec2 error = Vec2::Zero();  ///< Of this unit's receiver now.
  std::optional<Statement> honest;  ///< Of that vehicle, by an honest unit with the same errors.
  bool is_attacker = false;
  bool is_attack = false;
  std::string attack{};
};

/// Transmitters that are no vehicle of the world have ids from here on.
inline constexpr std::uint32_t kFirstDeviceId = 3000000001u;

/// Turns messages of one scenario into what goes over the wire, and tells what is true of them.
class MessageWriter {
 public:
  explicit MessageWriter(const Scenario& scenario);

  /// Everything but `seq`, which numbers what arrives.
  [[nodiscard]] bsm_t Encode(const Message& message) const;
  /// `bsm` is what became of `message`. Claims are read back from its integers; what is unavailable
  /// there is NaN.
  [[nodiscard]] truth_bsm_t Truth(const Message& message, const bsm_t& bsm) const;

 private:
  [[nodiscard]] std::int64_t Utime(double time_s) const;

  GeographicLib::LocalCartesian plane_;
  double road_height_m_;
  std::int64_t start_utime_;
  double leap_second_at_s_;  // 0 = never.
  bool is_sparse_;
};

}  // namespace v2vouch::sim
