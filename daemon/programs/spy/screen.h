// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <functional>
#include <string>

#include "daemon/programs/spy/spy_report.h"

namespace v2vouch::spy {

/// The terminal as long as it lives: no echo, keys at once, the screen as it was afterwards.
class Screen {
 public:
  Screen();
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Takes the keys that were pressed. @return false: the end was asked for.
  bool TakeKeys(const Moment& moment);
  void Draw(const Moment& moment, const std::string& title);

 private:
  void Key(char key, const Moment& moment);
  [[nodiscard]] std::vector<std::string> Channels(const Moment& moment) const;

  termios before_{};
  bool is_set_ = false;
  bool is_over_ = false;
  bool is_filtering_ = false;  // Keys go into the filter.
  bool is_tree_ = false;       // The tree of fields instead of words.
  std::string filter_;
  std::string opened_;  // Channel whose message is shown; empty: the table.
  std::size_t selected_ = 0, scroll_ = 0;
};

}  // namespace v2vouch::spy
