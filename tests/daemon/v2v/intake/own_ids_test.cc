// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/own_ids.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

Timestamp At(int seconds) {
  return FromMicros(1'700'000'000'000'000) + std::chrono::seconds(seconds);
}

TEST(OwnIds, AnIdIsOursForAMinuteAfterItsLastUse) {
  OwnIds ids;
  EXPECT_FALSE(ids.Has(0, At(0)));
  ids.Note(7, At(0));
  ids.Note(7, At(30));
  EXPECT_TRUE(ids.Has(7, At(90)));
  EXPECT_FALSE(ids.Has(7, At(91)));
  EXPECT_FALSE(ids.Has(8, At(30)));
}

TEST(OwnIds, AnIdIsKnownAfterTheIdentityHasChanged) {
  OwnIds ids;
  for (SenderId id = 1; id <= 5; ++id) ids.Note(id, At(static_cast<int>(id)));
  for (SenderId id = 2; id <= 5; ++id) EXPECT_TRUE(ids.Has(id, At(6))) << id;
  EXPECT_FALSE(ids.Has(1, At(6)));  // Four are remembered.
}

}  // namespace
}  // namespace v2vouch
