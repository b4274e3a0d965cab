// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace v2vouch {

/// One thing looked at.
struct Advice {
  enum class State { kGood, kNote, kBad };
  State state = State::kGood;
  std::string check;   ///< A short word: "route", "buffer", "clock".
  std::string text;    ///< What was found.
  std::string advice;  ///< What to do; "" where nothing is.
};

using AdviceList = std::vector<Advice>;

}  // namespace v2vouch
