// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Remembers identities that were heard once and not let in, in fixed memory. Who comes back has
/// knocked; a flood in which every message has an identity of its own never does, and so does not
/// spend what new senders are allowed.
///
/// A direct-mapped table of 16384 ids; a newer one takes the place of an older. Among 5000 random
/// identities a second, one that speaks again 0.1 s later is forgotten in 3 % of all cases.
class KnockMemory {
 public:
  KnockMemory();

  /// Whether this identity knocked within the last two seconds. Remembers it either way.
  bool Knock(SenderId sender, Timestamp now);

 private:
  struct Entry {
    SenderId sender = 0;
    std::uint32_t tick = 0;  // Units of 16.384 ms, plus one; 0 = empty.
  };
  std::vector<Entry> entries_;
};

}  // namespace v2vouch
