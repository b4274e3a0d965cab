// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/event_list.h"

#include <cmath>
#include <cstdio>

#include "daemon/common/data/check.h"
#include "daemon/rim/view/json_text.h"

namespace v2vouch::view {
namespace {

constexpr std::size_t kMostEvents = 2000;
constexpr std::size_t kMostRemembered = 4096;
constexpr std::int64_t kVerdictBelongs_us = 1'000'000;  // A vehicle that ends this soon after one.

std::string Short(std::int64_t id) {
  const std::string digits = std::to_string(id);
  return digits.size() > 5 ? digits.substr(digits.size() - 5) : digits;
}

std::string Seconds(std::int64_t us) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", 1e-6 * static_cast<double>(us));
  return text;
}

}  // namespace

std::uint32_t SenderOf(const std::uint8_t* octets) {
  std::uint32_t sender = 0;
  for (int i = 0; i < 4; ++i) sender = (sender << 8) | octets[i];
  return sender;
}

std::string CheckInWords(const std::string& check) {
  for (int i = 0; i < static_cast<int>(Check::kCount); ++i) {
    const CheckInfo& info = Describe(static_cast<Check>(i));
    if (info.name == check) return std::string(info.finds);
  }
  return check;
}

void EventList::Add(std::int64_t at, std::string kind, std::string text, std::int64_t track_id,
                    std::uint32_t sender) {
  if (is_frozen_) return;
  events_.push_back({next_number_++, at, std::move(kind), std::move(text), track_id, sender});
  if (events_.size() > kMostEvents) events_.pop_front();
}

void EventList::Forget() {
  vehicles_.clear();
  doubted_.clear();
  notices_.clear();
  has_list_ = false;
}

void EventList::TakePriority(const track_list_t& list, std::int64_t at) {
  std::map<std::int64_t, Vehicle> now;
  for (const track_t& track : list.tracks) {
    Vehicle vehicle;
    vehicle.sender = SenderOf(track.v2v_id);
    vehicle.is_bridged = track.trust_state == track_t::TRUST_BRIDGED || track.local_id == 0;
    const auto before = vehicles_.find(track.id);
    const std::string name = "vehicle " + Short(track.id);
    if (before == vehicles_.end()) {
      // The first list after a start says who is there, not what happened.
      if (has_list_) {
        Add(at, "validated",
            name + " is validated: sensors and sender " + SenderName(vehicle.sender) + " agree",
            track.id, vehicle.sender);
      }
      vehicle.bridged_since = at;
    } else {
      vehicle.bridged_since = before->second.bridged_since;
      if (vehicle.is_bridged && !before->second.is_bridged) {
        vehicle.bridged_since = at;
        const bool has_budget = std::isfinite(track.bridge_budget_s);
        Add(at, "bridged",
            name + " is hidden: carried by V2V" +
                (has_budget ? ", at most " + Seconds(static_cast<std::int64_t>(
                                                 1e6 * std::min(track.bridge_budget_s, 1e6)))
                            : std::string()),
            track.id, vehicle.sender);
      } else if (!vehicle.is_bridged && before->second.is_bridged) {
        Add(at, "seen_again",
            name + " is seen again after " + Seconds(at - before->second.bridged_since), track.id,
            vehicle.sender);
      }
    }
    if (now.size() < kMostRemembered) now[track.id] = vehicle;
  }
  for (const auto& [id, vehicle] : vehicles_) {
    if (now.contains(id)) continue;
    const auto verdict = doubted_.find(vehicle.sender);
    const bool is_withdrawn =
        verdict != doubted_.end() && at - verdict->second < kVerdictBelongs_us;
    Add(at, "ended",
        "vehicle " + Short(id) +
            (is_withdrawn ? " leaves PRIORITY: its sender is no longer believed"
                          : " leaves PRIORITY"),
        id, vehicle.sender);
  }
  vehicles_ = std::move(now);
  has_list_ = true;
}

void EventList::TakeReport(const misbehavior_report_t& report, std::int64_t at) {
  const std::uint32_t sender = SenderOf(report.sender_id);
  if (doubted_.size() >= kMostRemembered) doubted_.clear();
  doubted_[sender] = at;
  const bool is_accused = report.verdict == misbehavior_report_t::ACCUSE;
  Add(at, is_accused ? "accused" : "withdrawn",
      "sender " + SenderName(sender) + (is_accused ? " is accused: " : " is no longer believed: ") +
          CheckInWords(report.check),
      0, sender);
}

void EventList::TakeStatus(const daemon_status_t& status, std::int64_t at) {
  std::set<std::string> now;
  for (const notice_t& notice : status.notices) {
    std::string key = notice.name + "\n" + notice.channel;
    if (!notices_.contains(key)) {
      Add(at, "notice",
          notice.name + (notice.channel.empty() ? "" : " (" + notice.channel + ")") + ": " +
              notice.advice,
          0, 0);
    }
    now.insert(std::move(key));
  }
  notices_ = std::move(now);
}

}  // namespace v2vouch::view
