// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/object_class.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

TEST(ObjectClassName, EveryClassComesBackFromItsName) {
  for (int value = 1; value <= 7; ++value) {
    const auto object_class = static_cast<ObjectClass>(value);
    const auto name = ObjectClassName(object_class);
    EXPECT_FALSE(name.empty()) << value;
    EXPECT_EQ(ObjectClassOf(name), object_class);
  }
}

TEST(ObjectClassOf, UnknownTextIsNoClass) {
  EXPECT_FALSE(ObjectClassOf("").has_value());
  EXPECT_FALSE(ObjectClassOf("Car").has_value());
  EXPECT_TRUE(ObjectClassName(ObjectClass::kUnknown).empty());
}

}  // namespace
}  // namespace v2vouch
