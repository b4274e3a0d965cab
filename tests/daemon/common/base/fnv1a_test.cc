// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/fnv1a.h"

#include <gtest/gtest.h>

#include <array>

namespace v2vouch {
namespace {

std::uint64_t Of(std::string_view text) {
  Fnv1a hash;
  hash.Add(text);
  return hash.value();
}

// Published values: draft-eastlake-fnv, appendix C.
TEST(Fnv1a, GivesThePublishedValues) {
  EXPECT_EQ(Of(""), 0xCBF29CE484222325u);
  EXPECT_EQ(Of("a"), 0xAF63DC4C8601EC8Cu);
  EXPECT_EQ(Of("foobar"), 0x85944171F73967E8u);
}

TEST(Fnv1a, TakesAFigureAsItsBytesLeastSignificantFirst) {
  Fnv1a figure;
  figure.Add(std::int64_t{0x0807060504030201});
  Fnv1a bytes;
  bytes.Add(std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_EQ(figure.value(), bytes.value());
}

}  // namespace
}  // namespace v2vouch
