// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/foreign_outputs.h"

#include <algorithm>

#include "daemon/common/base/fnv1a.h"

namespace v2vouch {

void ForeignOutputs::Sent(std::span<const std::uint8_t> bytes) {
  const std::uint64_t hash = HashOf(bytes);
  const std::lock_guard lock(mutex_);
  sent_[next_++ % kRemembered] = hash;
}

void ForeignOutputs::Heard(std::span<const std::uint8_t> bytes) {
  const std::uint64_t hash = HashOf(bytes);
  const std::lock_guard lock(mutex_);
  const auto ours = std::ranges::find(sent_, hash);
  if (ours == sent_.end()) {
    ++count_;
  } else {
    *ours = 0;
  }
}

std::int64_t ForeignOutputs::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

std::uint64_t ForeignOutputs::HashOf(std::span<const std::uint8_t> bytes) {
  Fnv1a hash;
  hash.Add(bytes);
  return std::max<std::uint64_t>(hash.value(), 1);  // 0 is an empty slot.
}

}  // namespace v2vouch
