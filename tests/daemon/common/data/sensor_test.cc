// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/sensor.h"

#include <gtest/gtest.h>

#include <set>

namespace v2vouch {
namespace {

Timestamp At(int us) { return FromMicros(1'700'000'000'000'000 + us); }

TEST(SlotOf, IsAnotherOneForEverySensorThatCanBeConfigured) {
  std::set<std::size_t> slots;
  for (const SensorKind kind : kAllSensorKinds) {
    for (int i = 0; i < kMostSensorsOfAKind; ++i) slots.insert(SlotOf({kind, i}));
  }
  EXPECT_EQ(slots.size(), kSensorSlots);
  EXPECT_EQ(*slots.rbegin(), kSensorSlots - 1);
}

TEST(SensorSupport, KnowsTheLastMeasurementOfEachSensorAndTheHitsOfEachKind) {
  SensorSupport support;
  EXPECT_EQ(support.last(), Timestamp{});
  EXPECT_FALSE(support.last(SensorKind::kRadar));
  support.Add({SensorKind::kRadar, 3}, At(1));
  support.Add({SensorKind::kRadar, 4}, At(2));
  support.Add({SensorKind::kRadar, 3}, At(3));
  support.Add({SensorKind::kObjects, 0}, At(4));
  EXPECT_EQ(support.hits(SensorKind::kRadar), 3);
  EXPECT_EQ(support.hits(SensorKind::kCamera), 0);
  EXPECT_EQ(support.hits(), 4);
  EXPECT_EQ(support.last(SensorKind::kRadar), At(3));
  EXPECT_EQ(support.last(), At(4));
  EXPECT_TRUE(support.IsHitAt(At(3)));
  EXPECT_FALSE(support.IsHitAt(At(2))) << "radar 3 has seen it since";
  ASSERT_EQ(support.sources().size(), 3U);
  EXPECT_EQ(support.sources()[0].last, At(3));
}

TEST(SensorSupport, ManySensorsPushOutTheOneLongestSilent) {
  SensorSupport support;
  for (int i = 0; i < 17; ++i) support.Add({SensorKind::kRadar, i}, At(i));
  EXPECT_EQ(support.sources().size(), SensorSupport::kMostSources);
  for (const SensorSupport::Source& source : support.sources()) EXPECT_NE(source.sensor.index, 0);
  EXPECT_EQ(support.hits(), 17);
}

TEST(SensorSupport, SharesAFrameOnlyWithTheSameSensorAtTheSameTime) {
  SensorSupport a, b, c;
  a.Add({SensorKind::kObjects, 0}, At(1));
  b.Add({SensorKind::kObjects, 1}, At(1));
  c.Add({SensorKind::kObjects, 0}, At(1));
  EXPECT_FALSE(a.SharesFrame(b, SensorKind::kObjects));
  EXPECT_TRUE(a.SharesFrame(c, SensorKind::kObjects));
  EXPECT_FALSE(a.SharesFrame(c, SensorKind::kRadar));
  c.Add({SensorKind::kObjects, 0}, At(2));
  EXPECT_FALSE(a.SharesFrame(c, SensorKind::kObjects));
}

}  // namespace
}  // namespace v2vouch
