// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/vehicle.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

TEST(SensorKey, IsTheNameInLowerCase) {
  EXPECT_EQ(SensorKey("FRONT_Left2"), "front_left2");
  EXPECT_EQ(SensorKey(""), "");
}

}  // namespace
}  // namespace v2vouch
