// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/vehicle.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

TEST(LowerCaseName, IsTheNameInLowerCase) {
  EXPECT_EQ(LowerCaseName("FRONT_Left2"), "front_left2");
  EXPECT_EQ(LowerCaseName(""), "");
}

}  // namespace
}  // namespace v2vouch
