// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>

#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::view {

/// One mark on the time line.
struct ViewEvent {
  std::int64_t number = 0;  ///< Counts from 0, also over those forgotten.
  /// When the message that told it arrived, microseconds. `bridged` comes up to 0.3 s after that.
  std::int64_t at = 0;
  /// validated, bridged, seen_again, ended, withdrawn, accused, warned, notice.
  std::string kind;
  std::string text;           ///< One plain sentence.
  std::int64_t track_id = 0;  ///< Of PRIORITY; 0 = none.
  std::uint32_t sender = 0;   ///< 0 = none.
  std::int64_t local_id = 0;  ///< Of LOCAL, where the vehicle is not in PRIORITY; 0 = none.
};

/// Finds what happened by comparing each message with the one before. Keeps the newest 2000.
class EventList {
 public:
  /// `at`: when the message arrived, microseconds.
  void TakePriority(const track_list_t& list, std::int64_t at);
  void TakeReport(const misbehavior_report_t& report, std::int64_t at);
  void TakeStatus(const daemon_status_t& status, std::int64_t at);
  /// A warning that begins, and one that grows stronger; from the level ADVISE on.
  void TakeWarnings(const warning_list_t& list, std::int64_t at);
  /// No event is added any more: the whole drive's are known.
  void Freeze() { is_frozen_ = true; }
  /// After a jump in time: what is compared with is forgotten, the events stay.
  void Forget();

  [[nodiscard]] const std::deque<ViewEvent>& events() const { return events_; }
  /// Number that the next event will have.
  [[nodiscard]] std::int64_t next_number() const { return next_number_; }

 private:
  struct Vehicle {
    std::uint32_t sender = 0;
    bool is_bridged = false;
    bool is_told = false;  ///< That it is bridged.
    std::int64_t bridged_since = 0;
    std::string bridged_text;
  };
  /// Tells that it is bridged once that has lasted: at its first sight a vehicle may be so for one
  /// list.
  void TellBridged(Vehicle& vehicle, std::int64_t id, std::int64_t at);
  void Add(std::int64_t at, std::string kind, std::string text, std::int64_t track_id,
           std::uint32_t sender, std::int64_t local_id = 0);

  std::deque<ViewEvent> events_;
  std::int64_t next_number_ = 0;
  std::map<std::int64_t, Vehicle> vehicles_;
  std::map<std::uint32_t, std::int64_t> doubted_;  // Sender -> when a verdict last spoke.
  std::set<std::string> notices_;
  std::map<std::pair<int, std::int64_t>, int>
      warnings_;  // (kind, vehicle) -> highest level so far.
  bool has_list_ = false;
  bool is_frozen_ = false;
};

/// The check's name, and what it finds, in plain words.
std::string CheckInWords(const std::string& check);
/// What a message's sender is trusted with (track_t::TRUST_...), in words.
const char* TrustInWords(int trust);

}  // namespace v2vouch::view
