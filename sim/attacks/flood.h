// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/base/random.h"
#include "sim/attacks/gate.h"
#include "sim/sensors/message.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// A message that no honest unit's could be turned into.
struct RawMessage {
  bsm_t bsm{};
  bool is_cut = false;  ///< Only the first half of its bytes arrive.
};

/// A device that sends by the thousand (FloodSpec). Random content: cars anywhere round the ego, at
/// any speed, with valid values, each under an identity of its own. Malformed: the same with one
/// value that J2735 does not have, every fifth cut short instead.
class Flood {
 public:
  Flood(const AttackSpec& attack, const World& world, std::uint32_t device, std::uint64_t seed);

  /// Appends what it sends until `until_s`.
  void Run(double until_s, std::vector<RawMessage>& sent);

 private:
  RawMessage Make(double time_s);

  const World& world_;
  FloodSpec spec_;
  MessageWriter writer_;
  Gate gate_;
  Random random_;
  std::int64_t next_ = 0;
};

}  // namespace v2vouch::sim
