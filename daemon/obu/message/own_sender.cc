// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/message/own_sender.h"

#include <algorithm>
#include <cmath>

#include "daemon/obu/message/bsm_message.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kUnitMemory_us = 10000000;

bool IsFresh(const std::optional<std::int64_t>& of, std::int64_t utime, std::int64_t limit_us) {
  return of && std::abs(utime - *of) <= limit_us;
}

}  // namespace

std::string_view OwnStateName(OwnState state) {
  constexpr std::array<std::string_view, 5> kNames = {"off", "sending", "no_fix", "no_motion",
                                                      "unit_sends"};
  return kNames.at(static_cast<std::size_t>(state));
}

OwnSender::OwnSender(const OwnSenderConfig& config, std::uint64_t seed)
    : config_(config), own_(config.vehicle, seed), period_us_(std::llround(1e6 / config.rate_hz)) {}

void OwnSender::OnMotion(const ego_motion_t& motion) {
  if (own_.OnMotion(motion)) motion_utime_ = motion.utime;
}

void OwnSender::OnFix(const gnss_fix_t& fix) {
  if (own_.OnFix(fix)) fix_utime_ = fix.utime;
}

void OwnSender::OnUnitSent(std::uint32_t id, std::int64_t utime) {
  if (std::ranges::find(ids_, id) == ids_.end()) unit_sent_utime_ = utime;
}

OwnState OwnSender::StateAt(std::int64_t utime) const {
  if (IsFresh(unit_sent_utime_, utime, kUnitMemory_us)) return OwnState::kUnitSends;
  if (!IsFresh(fix_utime_, utime, kOldestFix_us)) return OwnState::kNoFix;
  if (!IsFresh(motion_utime_, utime, kOldestMotion_us)) return OwnState::kNoMotion;
  return OwnState::kSending;
}

std::optional<OwnSender::Message> OwnSender::Step(std::int64_t utime) {
  state_ = StateAt(utime);
  if (utime < due_ && due_ - utime <= period_us_) return std::nullopt;
  // Steady while we keep up; from now after a pause or a step of the clock.
  due_ = due_ + period_us_ > utime && due_ <= utime ? due_ + period_us_ : utime + period_us_;
  if (state_ != OwnState::kSending) return std::nullopt;
  const auto bsm = own_.Make(utime);
  if (!bsm) return std::nullopt;
  Message message;
  message.datagram = DatagramOf(*bsm, config_.form, config_.text);
  if (message.datagram.empty()) return std::nullopt;
  if (ids_[0] != own_.id()) {
    std::rotate(ids_.begin(), ids_.end() - 1, ids_.end());
    ids_[0] = own_.id();
  }
  Datagram sent;
  sent.bsm = *bsm;
  message.bsm = BsmMessage(sent, {.rx_utime = utime, .seq = ++sent_});
  return message;
}

}  // namespace v2vouch::obu
