// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/radio/radio_config.h"

namespace v2vouch::sim {

/// Probability that a message arrives, interference apart:
///
///     p(d) = 1 / (1 + (d / d50)^k),   d50 = d90 9^(1/k),  so that p(d90) = 0.9
double ReceptionProbability(const LinkSpec& spec, double distance_m, bool is_blocked);

/// The way from one car to another. Its draws depend on seed, the two cars and the number of its
/// messages alone: what others send changes nothing. Messages come in order of time.
class Link {
 public:
  Link(const LinkSpec& spec, std::uint64_t seed, std::uint64_t from, std::uint64_t to);

  struct Copy {
    std::int64_t delay_us = 0;
    int signal_dbm = 0;
  };
  enum class Fate : std::uint8_t { kHeard, kTooFar, kInterference };
  struct Outcome {
    Fate fate = Fate::kHeard;
    std::vector<Copy> copies;  ///< Empty unless heard.
  };
  Outcome Carry(std::int64_t utime, double distance_m, bool is_blocked);

 private:
  bool IsInterfered(std::int64_t utime);
  [[nodiscard]] Copy DrawCopy(Random& random, double distance_m, bool is_blocked) const;

  LinkSpec spec_;
  std::uint64_t seed_, from_, to_;
  std::uint64_t messages_ = 0;
  Random spells_;
  bool is_bad_ = false;
  std::int64_t changes_at_ = 0;
  double shadow_db_ = 0.0;
  std::int64_t last_utime_ = 0;
};

}  // namespace v2vouch::sim
