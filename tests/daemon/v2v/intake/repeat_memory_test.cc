// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/repeat_memory.h"

#include <gtest/gtest.h>

#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

using Finding = RepeatMemory::Finding;

TEST(RepeatMemory, KnowsAMessageForItsTimeAndForgetsItThen) {
  RepeatMemory memory(1000, 120.0);
  Bsm bsm = TalkingCar{}.Say();
  EXPECT_EQ(memory.Look(bsm).finding, Finding::kNew);
  memory.Keep(bsm);
  EXPECT_EQ(memory.Look(bsm).finding, Finding::kRepeat);
  bsm.stamp += FromSeconds(119.0);
  EXPECT_EQ(memory.Look(bsm).finding, Finding::kRepeat);
  bsm.stamp += FromSeconds(2.0);
  EXPECT_EQ(memory.Look(bsm).finding, Finding::kNew);
}

TEST(RepeatMemory, EveryPartOfTheCoreCounts) {
  RepeatMemory memory(1000, 120.0);
  const Bsm bsm = TalkingCar{}.Say();
  memory.Keep(bsm);
  const auto finding = [&](auto change) {
    Bsm other = bsm;
    change(other);
    return memory.Look(other).finding;
  };
  EXPECT_EQ(finding([](Bsm& b) { b.msg_count += 1; }), Finding::kNew);
  EXPECT_EQ(finding([](Bsm& b) { *b.sec_mark_ms += 1; }), Finding::kNew);
  EXPECT_EQ(finding([](Bsm& b) { *b.latitude_rad += 1e-9; }), Finding::kNew);
  EXPECT_EQ(finding([](Bsm& b) { *b.longitude_rad += 1e-9; }), Finding::kNew);
  EXPECT_EQ(finding([](Bsm& b) { b.sender += 1; }), Finding::kOtherSender);
  EXPECT_EQ(finding([](Bsm& b) { b.speed_mps = 3.0; }), Finding::kRepeat);
}

TEST(RepeatMemory, NamesTheOtherSender) {
  RepeatMemory memory(1000, 120.0);
  Bsm bsm = TalkingCar{}.Say();
  memory.Keep(bsm);
  const SenderId first = bsm.sender;
  bsm.sender = 77;
  EXPECT_EQ(memory.Look(bsm).id_tag, RepeatMemory::IdTag(first));
  EXPECT_NE(RepeatMemory::IdTag(first), RepeatMemory::IdTag(77));
}

TEST(RepeatMemory, AParkedCarWithoutTimeMaySayTheSameAgain) {
  RepeatMemory memory(1000, 120.0);
  Bsm bsm = TalkingCar{}.Say();
  bsm.sec_mark_ms.reset();
  memory.Keep(bsm);
  bsm.stamp += FromSeconds(12.8);  // msgCnt has gone round at 10 Hz.
  EXPECT_EQ(memory.Look(bsm).finding, Finding::kNew);
}

TEST(RepeatMemory, AFullTableForgetsTheOldestAndMistakesNothing) {
  RepeatMemory memory(1024, 120.0);
  TalkingCar car;
  std::vector<Bsm> said;
  for (int i = 0; i < 4096; ++i) {
    car.Drive(0.01);
    said.push_back(car.Say());
    EXPECT_EQ(memory.Look(said.back()).finding, Finding::kNew) << i;
    memory.Keep(said.back());
  }
  int remembered = 0;
  for (std::size_t i = said.size() - 512; i < said.size(); ++i) {
    remembered += memory.Look(said[i]).finding == Finding::kRepeat ? 1 : 0;
  }
  EXPECT_GT(remembered, 480);
  EXPECT_EQ(memory.Look(said.front()).finding, Finding::kNew);
}

}  // namespace
}  // namespace v2vouch
