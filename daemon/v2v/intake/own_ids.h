// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// The TemporaryIDs under which this car itself has spoken of late. An echo may come after the
/// identity has changed, so the latest four are known, each for a minute after it was last used.
class OwnIds {
 public:
  void Note(SenderId id, Timestamp at);
  [[nodiscard]] bool Has(SenderId id, Timestamp now) const;

 private:
  struct Used {
    SenderId id = 0;
    Timestamp last{};
    bool is_set = false;
  };
  std::array<Used, 4> used_{};  // Latest first.
};

}  // namespace v2vouch
