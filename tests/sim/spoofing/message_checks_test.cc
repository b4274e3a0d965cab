// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/message_checks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "daemon/common/base/angle.h"
#include "tests/sim/spoofing/spoof_scene.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::uint32_t kLiar = 0xB2;

// Car 2 drives east at 10 m/s for 10 s; `change` shapes its messages from 5 s on.
std::vector<bool> Flags(const std::function<void(BsmTruth&, double)>& change) {
  SpoofScene scene(12.0);
  scene.AddCar(2, {20.0, 0.0}, 10.0, kLiar);
  AtTenHertz(0.0, 10.0, [&](double t) {
    BsmTruth& m = scene.Say(t, 12, kLiar, 2, 3);
    if (t > 4.95) change(m, t);
  });
  return CheckMessages(scene.log());
}

long CountFrom(const std::vector<bool>& flags, std::size_t from) {
  return std::count(flags.begin() + static_cast<long>(from), flags.end(), true);
}

TEST(MessageChecks, AnHonestSenderIsFlaggedForItsSuddenAppearanceOnly) {
  const auto flags = Flags([](BsmTruth&, double) {});
  EXPECT_TRUE(flags[0]);
  // 11.01 falls by 1 per message to below 5.5 within six.
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 6);
  EXPECT_EQ(CountFrom(flags, 10), 0);
}

TEST(MessageChecks, AJumpIsFlaggedAtOnceForAtLeastSixMessages) {
  const auto flags = Flags([](BsmTruth& m, double) { m.claimed.p_W.y() += 30.0; });
  EXPECT_FALSE(flags[49]);
  for (std::size_t i = 50; i < 56; ++i) EXPECT_TRUE(flags[i]) << i;
}

TEST(MessageChecks, ASlowDriftIsNotSeen) {
  const auto flags = Flags([](BsmTruth& m, double t) { m.claimed.p_W.y() += 0.5 * (t - 5.0); });
  EXPECT_EQ(CountFrom(flags, 50), 0);
}

TEST(MessageChecks, AReversedHeadingIsFlaggedAllAlong) {
  const auto flags = Flags([](BsmTruth& m, double) { m.claimed.yaw_rad += kPi; });
  EXPECT_EQ(CountFrom(flags, 50), 50);
}

TEST(MessageChecks, SpeedAndRangeHaveLimits) {
  EXPECT_EQ(CountFrom(Flags([](BsmTruth& m, double) { m.claimed.speed_mps = 41.0; }), 50), 50);
  EXPECT_EQ(CountFrom(Flags([](BsmTruth& m, double) { m.claimed.p_W.x() += 450.0; }), 50), 50);
}

TEST(MessageChecks, ARepeatedTimeIsTooShortAnInterval) {
  EXPECT_GE(CountFrom(Flags([](BsmTruth& m, double t) { m.age_s += t - 5.0; }), 51), 45);
}

TEST(MessageChecks, AnOvertakenMessageIsNoLieAndAFastCarNone) {
  SpoofScene scene(12.0);
  scene.AddCar(2, {-300.0, 0.0}, 34.0, kLiar);
  AtTenHertz(0.0, 10.0, [&](double t) {
    BsmTruth& m = scene.Say(t, 12, kLiar, 2, 3);
    const bool is_late = std::abs(t - 5.0) < 0.01;  // Sent before the one that came at 4.9 s.
    if (is_late) m.age_s += 0.2;
    if (is_late) m.claimed.p_W.x() -= 6.8;
  });
  EXPECT_EQ(CountFrom(CheckMessages(scene.log()), 10), 0);
}

TEST(MessageChecks, TwoSendersInOnePlaceAreFlagged) {
  SpoofScene scene(12.0);
  scene.AddCar(2, {20.0, 0.0}, 10.0, kLiar);
  AtTenHertz(0.0, 10.0, [&](double t) {
    scene.Say(t, 12, kLiar, 2, 3);
    scene.Say(t + 0.02, 13, 0xC3, 2, 3).claimed.p_W.x() += t < 5.0 ? 8.0 : 0.5;
  });
  const auto flags = CheckMessages(scene.log());
  EXPECT_EQ(std::count(flags.begin() + 20, flags.begin() + 100, true), 0);
  EXPECT_GT(CountFrom(flags, 102), 90);
}

}  // namespace
}  // namespace v2vouch::evaluation
