// SPDX-License-Identifier: Apache-2.0
// libFuzzer's entry; scripts/fuzz_lcm builds and runs it with clang.
#include "tests/fuzz/lcm_packets_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  v2vouch::testing::RunSteps(v2vouch::testing::UnpackSteps({data, size}));
  return 0;
}
