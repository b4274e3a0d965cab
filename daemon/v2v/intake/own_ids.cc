// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/own_ids.h"

#include <algorithm>

namespace v2vouch {
namespace {

constexpr Duration kMemory = std::chrono::seconds(60);

}  // namespace

void OwnIds::Note(SenderId id, Timestamp at) {
  auto found = std::ranges::find_if(used_, [id](const Used& u) { return u.is_set && u.id == id; });
  if (found == used_.end()) found = used_.end() - 1;
  std::rotate(used_.begin(), found, found + 1);
  used_.front() = {id, at, true};
}

bool OwnIds::Has(SenderId id, Timestamp now) const {
  return std::ranges::any_of(
      used_, [&](const Used& u) { return u.is_set && u.id == id && now - u.last <= kMemory; });
}

}  // namespace v2vouch
