// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "daemon/rim/engine/engine.h"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::testing {

/// What the core publishes as text that a person can read and `git diff` can compare: the three
/// lists twice a second, every misbehaviour report, and what was refused.
///
/// Lengths in metres and centimetres, angles in tenths of a degree, times since the first list.
/// Track ids are numbered by first appearance ("L1", "P1"), so that a changed id shows and a
/// changed hash does not.
class ListText {
 public:
  void Add(const Outbox::Message& message);
  /// Counts of refused messages and fields, by channel; call once, last.
  void AddRefusals(const Engine& engine);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void AddList(const std::string& channel, const track_list_t& list);
  void AddReport(const misbehavior_report_t& report);
  std::string Time(std::int64_t utime);
  std::string Name(char list, std::int64_t id);

  std::string text_;
  std::int64_t begin_ = 0;
  std::map<std::string, std::int64_t> next_;  // Half second after the one written, by channel.
  std::map<char, std::map<std::int64_t, int>> names_;
};

}  // namespace v2vouch::testing
