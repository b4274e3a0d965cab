// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "daemon/obu/j2735/message_frame.h"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"

namespace v2vouch::obu {

/// The own car, as its BSM tells it. Body frame as in ego_motion_t.
struct OwnVehicle {
  double antenna_x_m = 0.0;
  double antenna_y_m = 0.0;
  double centre_x_m = 0.0;  ///< Centre of the footprint ahead of the rear axle.
  double length_m = 0.0;
  double width_m = 0.0;
  std::int64_t id_change_us = 300000000;  ///< A new TemporaryID after this; 0 = never.
};

inline constexpr std::int64_t kOldestFix_us = 1500000;  ///< A receiver of 1 Hz, and its delay.
inline constexpr std::int64_t kOldestMotion_us = 500000;

/// Makes the own car's BSMs of its odometry and GNSS. Reads no clock: time is the caller's.
///
///     place   = fix carried forward to `utime`, moved from the antenna to the footprint's centre
///     secMark = time of that place
///
/// What is not known says "unavailable", never zero; what is too large for its field takes the
/// largest value there is, and is counted: one bad figure never stops the stream.
class OwnBsm {
 public:
  /// @param seed of the TemporaryIDs and first counts.
  OwnBsm(OwnVehicle vehicle, std::uint64_t seed);

  /// @return whether it can be used.
  bool OnMotion(const ego_motion_t& motion);
  bool OnFix(const gnss_fix_t& fix);

  /// The message for this moment, or nullopt while there is no fix of the last 1.5 s.
  std::optional<Bsm> Make(std::int64_t utime);

  [[nodiscard]] std::uint32_t id() const { return id_; }  ///< Of the latest message.
  [[nodiscard]] std::int64_t saturated() const { return saturated_; }

 private:
  void ChangeId(std::int64_t utime);
  [[nodiscard]] std::optional<double> BodyHeading(double speed_mps) const;

  OwnVehicle vehicle_;
  std::mt19937_64 rng_;
  std::optional<ego_motion_t> motion_;
  std::optional<gnss_fix_t> fix_;
  std::optional<double> course_rad_;  // Last body axis known, clockwise from north.
  std::uint32_t id_ = 0;
  std::int64_t id_since_ = 0;
  int msg_count_ = 0;
  std::int64_t saturated_ = 0;
};

/// Forms in which units take a message for sending.
enum class OutputForm : std::uint8_t {
  kFrame,    ///< Bare MessageFrame.
  kDot2,     ///< IEEE 1609.2, unsecured.
  kRsuText,  ///< RSU 4.1 immediate forward, UDP 1516; the unit signs where `signs`.
};

struct RsuTextOptions {
  bool signs = false;  ///< "Signature": the unit signs what it sends.
  int channel = 183;   ///< 183 C-V2X; 172 or 180 DSRC.
  int priority = 6;    ///< 0 to 7.
};

/// The datagram for a unit; empty where the core has a value outside its range.
std::vector<std::uint8_t> DatagramOf(const Bsm& bsm, OutputForm form,
                                     const RsuTextOptions& options = {});

}  // namespace v2vouch::obu
