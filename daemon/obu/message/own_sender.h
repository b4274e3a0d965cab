// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "daemon/obu/message/own_bsm.h"
#include "v2vouch/bsm_t.hpp"

namespace v2vouch::obu {

/// Whether the own car's BSMs go out, and why not. Numbers as in obu_status_t.
enum class OwnState : std::int8_t {
  kOff = 0,
  kSending = 1,
  kNoFix = 2,      ///< No EGO_GNSS of the last 1.5 s.
  kNoMotion = 3,   ///< No EGO_MOTION of the last 0.5 s.
  kUnitSends = 4,  ///< The unit sends BSMs of its own: two streams of one car are worse than none.
};
std::string_view OwnStateName(OwnState state);

struct OwnSenderConfig {
  OwnVehicle vehicle{};
  OutputForm form = OutputForm::kRsuText;
  RsuTextOptions text{};
  double rate_hz = 10.0;
};

/// Says when the own car speaks, and what. Silent while one of its inputs is stale, so that no
/// receiver is given a position that the car has left. Reads no clock: time is the caller's.
class OwnSender {
 public:
  /// @param seed of the TemporaryIDs and first counts.
  OwnSender(const OwnSenderConfig& config, std::uint64_t seed);

  void OnMotion(const ego_motion_t& motion);
  void OnFix(const gnss_fix_t& fix);
  /// A BSM that the unit reports as sent by itself. Ours among them are what it should send.
  void OnUnitSent(std::uint32_t id, std::int64_t utime);

  struct Message {
    std::vector<std::uint8_t> datagram;  ///< For the unit.
    bsm_t bsm;                           ///< For channel OWN_BSM.
  };
  /// The message that is due at `utime`; nullopt between messages and while there is silence.
  std::optional<Message> Step(std::int64_t utime);
  [[nodiscard]] std::int64_t due() const { return due_; }

  /// At the latest step.
  [[nodiscard]] OwnState state() const { return state_; }
  [[nodiscard]] std::uint32_t id() const { return sent_ > 0 ? own_.id() : 0; }
  [[nodiscard]] std::int64_t sent() const { return sent_; }
  [[nodiscard]] std::int64_t saturated() const { return own_.saturated(); }

 private:
  [[nodiscard]] OwnState StateAt(std::int64_t utime) const;

  OwnSenderConfig config_;
  OwnBsm own_;
  std::int64_t period_us_;
  std::int64_t due_ = 0;
  std::optional<std::int64_t> fix_utime_, motion_utime_, unit_sent_utime_;
  OwnState state_ = OwnState::kNoFix;
  std::int64_t sent_ = 0;
  std::array<std::uint32_t, 4> ids_{};  // Latest first: a unit may report what it sent late.
};

}  // namespace v2vouch::obu
