// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/event_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "daemon/common/data/check.h"
#include "daemon/rim/wire/sender_id.h"

namespace v2vouch::view {
namespace {

using wire::SenderName;
using wire::SenderOf;

constexpr std::size_t kMostEvents = 2000;
constexpr std::size_t kMostRemembered = 4096;
constexpr std::int64_t kBridgedLasts_us = 300'000;
constexpr std::int64_t kVerdictBelongs_us = 1'000'000;  // A vehicle that ends this soon after one.

std::string Short(std::int64_t id) {
  const std::string digits = std::to_string(id);
  return digits.size() > 5 ? digits.substr(digits.size() - 5) : digits;
}

const char* KindInWords(int kind) {
  constexpr std::array kWords = {"warned of",
                                 "collision ahead with",
                                 "hard braking ahead of us:",
                                 "crossing traffic:",
                                 "oncoming while turning left:",
                                 "beside us:",
                                 "in the way of a lane change:"};
  const bool is_known = kind > 0 && kind < static_cast<int>(kWords.size());
  return kWords[static_cast<std::size_t>(is_known ? kind : 0)];
}

const char* LevelInWords(int level) {
  switch (level) {
    case warning_t::ADVISE:
      return "caution: ";
    case warning_t::WARN:
      return "warning: ";
    case warning_t::URGENT:
      return "urgent: ";
    default:
      return "";
  }
}

std::string Seconds(std::int64_t us) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", 1e-6 * static_cast<double>(us));
  return text;
}

}  // namespace

std::string CheckInWords(const std::string& check) {
  for (int i = 0; i < static_cast<int>(Check::kCount); ++i) {
    const CheckInfo& info = Describe(static_cast<Check>(i));
    if (info.name == check) return std::string(info.finds);
  }
  return check;
}

void EventList::Add(std::int64_t at, std::string kind, std::string text, std::int64_t track_id,
                    std::uint32_t sender, std::int64_t local_id) {
  if (is_frozen_) return;
  events_.push_back(
      {next_number_++, at, std::move(kind), std::move(text), track_id, sender, local_id});
  if (events_.size() > kMostEvents) events_.pop_front();
}

void EventList::Forget() {
  vehicles_.clear();
  doubted_.clear();
  notices_.clear();
  warnings_.clear();
  has_list_ = false;
}

void EventList::TellBridged(Vehicle& vehicle, std::int64_t id, std::int64_t at) {
  if (vehicle.is_told || at - vehicle.bridged_since < kBridgedLasts_us) return;
  vehicle.is_told = true;
  // One that is hidden at its first sight was not seen to become so.
  if (vehicle.bridged_text.empty()) return;
  Add(vehicle.bridged_since, "bridged", vehicle.bridged_text, id, vehicle.sender);
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
      Vehicle& last = before->second;
      if (vehicle.is_bridged && !last.is_bridged) {
        vehicle.bridged_since = at;
        vehicle.bridged_text = name + " is hidden: carried by V2V";
        if (std::isfinite(track.bridge_budget_s)) {
          const double budget_s = std::min(track.bridge_budget_s, 1e6);
          vehicle.bridged_text += ", at most " + Seconds(static_cast<std::int64_t>(1e6 * budget_s));
        }
      } else if (vehicle.is_bridged) {
        TellBridged(last, track.id, at);
        vehicle.is_told = last.is_told;
        vehicle.bridged_since = last.bridged_since;
        vehicle.bridged_text = std::move(last.bridged_text);
      } else if (last.is_bridged) {
        TellBridged(last, track.id, at);
        if (last.is_told) {
          Add(at, "seen_again", name + " is seen again after " + Seconds(at - last.bridged_since),
              track.id, vehicle.sender);
        }
      }
    }
    if (now.size() < kMostRemembered) now[track.id] = vehicle;
  }
  for (auto& [id, vehicle] : vehicles_) {
    if (now.contains(id)) continue;
    if (vehicle.is_bridged) TellBridged(vehicle, id, at);
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

void EventList::TakeWarnings(const warning_list_t& list, std::int64_t at) {
  std::map<std::pair<int, std::int64_t>, int> now;
  for (const warning_t& warning : list.warnings) {
    if (warning.level < warning_t::ADVISE || warning.level > warning_t::URGENT) continue;
    if (now.size() >= kMostRemembered) break;
    // A vehicle goes by the same id while it is seen, whichever lists hold it.
    const std::int64_t id = warning.local_id != 0 ? warning.local_id : warning.track_id;
    const auto key = std::make_pair(static_cast<int>(warning.kind), id);
    const auto before = warnings_.find(key);
    const int highest = before == warnings_.end() ? 0 : before->second;
    now[key] = std::max<int>(highest, warning.level);
    if (warning.level <= highest) continue;
    std::string text = std::string(LevelInWords(warning.level)) + KindInWords(warning.kind) +
                       " vehicle " + Short(warning.track_id != 0 ? warning.track_id : id);
    if (std::isfinite(warning.time_to_conflict_s)) {
      text += ", contact in " + Seconds(static_cast<std::int64_t>(
                                    1e6 * std::clamp(warning.time_to_conflict_s, 0.0, 1e6)));
    }
    if (warning.local_id == 0) text += "; hidden, known by V2V";
    Add(at, "warned", std::move(text), warning.track_id, 0,
        warning.track_id == 0 ? warning.local_id : 0);
  }
  warnings_ = std::move(now);
}

const char* TrustInWords(int trust) {
  switch (trust) {
    case track_t::TRUST_UNKNOWN:
      return "heard; not compared with any track";
    case track_t::TRUST_CANDIDATE:
      return "agrees with a track so far; not validated";
    case track_t::TRUST_VALIDATED:
      return "the sensors see its vehicle where it says";
    case track_t::TRUST_BRIDGED:
      return "its vehicle is hidden; the message carries it";
    case track_t::TRUST_SUSPECT:
      return "no longer believed";
    case track_t::TRUST_REVOKED:
      return "accused; not believed";
    default:
      return "accepted";
  }
}

}  // namespace v2vouch::view
