// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Admission filter for new identities, in fixed memory. The first message of an unknown id leaves
/// an admission token; a second one within 2 s finds it and may be admitted. In a flood
/// where every message has its own identity no second message comes, so the flood does not spend
/// the budget of new senders.
///
/// A direct-mapped table of 16384 ids; a newer one takes the place of an older. Among 5000 random
/// identities a second, one that speaks again 0.1 s later is forgotten in 3 % of all cases.
class KnockMemory {
 public:
  KnockMemory();

  /// Whether this identity left a token within the last two seconds. Leaves one either way.
  bool Knock(SenderId sender, Timestamp now);

 private:
  struct Entry {
    SenderId sender = 0;
    std::uint32_t tick = 0;  // Units of 16.384 ms, plus one; 0 = empty.
  };
  std::vector<Entry> entries_;
};

}  // namespace v2vouch
