// SPDX-License-Identifier: Apache-2.0
// Round trip through the wire library; a message cut short is refused, not believed.
#include <cstdio>
#include <v2vouch/ego_motion_t.hpp>
#include <vector>

#include "daemon/rim/wire/codec.h"

int main() {
  v2vouch::ego_motion_t motion{};
  motion.speed_mps = 12.5;
  std::vector<std::uint8_t> bytes;
  v2vouch::wire::Encode(motion, bytes);
  const auto again = v2vouch::wire::Decode<v2vouch::ego_motion_t>(bytes);
  bytes.pop_back();
  const auto cut = v2vouch::wire::Decode<v2vouch::ego_motion_t>(bytes);
  std::puts(again && again->speed_mps == 12.5 && !cut ? "good" : "bad");
}
