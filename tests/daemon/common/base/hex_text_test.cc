// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/hex_text.h"

#include <gtest/gtest.h>

#include <array>

namespace v2vouch {
namespace {

TEST(HexText, HasTwoDigitsForEveryByteInTheOrderOfTheBytes) {
  const std::array<std::uint8_t, 4> bytes{0x00, 0x0F, 0xA5, 0xFF};
  EXPECT_EQ(HexText(bytes), "000fa5ff");
  EXPECT_EQ(UpperHexText(bytes), "000FA5FF");
}

TEST(HexText, IsEmptyForNoBytes) { EXPECT_EQ(HexText({}), ""); }

}  // namespace
}  // namespace v2vouch
