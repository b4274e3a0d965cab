// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/message/own_sender.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/big_endian.h"
#include "daemon/obu/framing/datagram.h"
#include "tests/support/obu_samples.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kStart = 1700000047400000;

ego_motion_t Motion(std::int64_t utime) {
  ego_motion_t motion{};
  motion.utime = utime;
  motion.speed_mps = 10.0;
  motion.gear = ego_motion_t::GEAR_FORWARD;
  return motion;
}

gnss_fix_t Fix(std::int64_t utime) {
  gnss_fix_t fix{};
  fix.utime = utime;
  fix.latitude_rad = FromDegrees(48.0);
  fix.longitude_rad = FromDegrees(11.0);
  fix.heading_rad = FromDegrees(90.0);
  fix.heading_sigma_rad = 0.01;
  fix.fix_type = gnss_fix_t::FIX_3D;
  return fix;
}

OwnSender BareSender() {
  OwnSenderConfig config;
  config.form = OutputForm::kFrame;
  return OwnSender(config, 5);
}

// Steps every millisecond as a loop would, with fixes at 1 Hz and motion at 20 Hz where wanted.
struct Drive {
  OwnSender sender = BareSender();
  std::int64_t now = kStart;
  std::vector<OwnSender::Message> messages{};

  void Run(double seconds, bool has_fix = true, bool has_motion = true) {
    for (const std::int64_t end = now + std::llround(seconds * 1e6); now < end; now += 1000) {
      if (has_fix && (now - kStart) % 1000000 == 0) sender.OnFix(Fix(now - 150000));
      if (has_motion && (now - kStart) % 50000 == 0) sender.OnMotion(Motion(now - 20000));
      if (auto message = sender.Step(now)) messages.push_back(std::move(*message));
    }
  }
};

TEST(OwnSender, SpeaksTenTimesASecondWithAFixEverySecond) {
  Drive drive;
  drive.Run(5.0);
  EXPECT_EQ(drive.messages.size(), 50u);
  EXPECT_EQ(drive.sender.state(), OwnState::kSending);
  EXPECT_EQ(drive.sender.sent(), 50);
  for (std::size_t i = 1; i < drive.messages.size(); ++i) {
    EXPECT_EQ(drive.messages[i].bsm.rx_utime - drive.messages[i - 1].bsm.rx_utime, 100000);
  }
}

TEST(OwnSender, IsSilentWithoutAFixOrWithoutMotion) {
  Drive drive;
  drive.Run(2.0, false, true);
  EXPECT_EQ(drive.sender.state(), OwnState::kNoFix);
  EXPECT_EQ(drive.sender.id(), 0u);
  EXPECT_TRUE(drive.messages.empty());
  Drive other;
  other.Run(2.0, true, false);
  EXPECT_EQ(other.sender.state(), OwnState::kNoMotion);
  EXPECT_TRUE(other.messages.empty());
}

TEST(OwnSender, StopsWhenAnInputGoesStaleAndGoesOnWhenItIsBack) {
  Drive drive;
  drive.Run(2.0);
  const std::size_t before = drive.messages.size();
  drive.Run(3.0, true, false);
  EXPECT_EQ(drive.sender.state(), OwnState::kNoMotion);
  EXPECT_LE(drive.messages.size(), before + 5);
  const std::size_t then = drive.messages.size();
  drive.Run(3.0, false, true);
  EXPECT_EQ(drive.sender.state(), OwnState::kNoFix);
  EXPECT_LE(drive.messages.size(), then + 10);
  const std::size_t last = drive.messages.size();
  drive.Run(2.0);
  EXPECT_EQ(drive.sender.state(), OwnState::kSending);
  EXPECT_NEAR(static_cast<double>(drive.messages.size() - last), 20.0, 1.0);
}

TEST(OwnSender, InputsOfAnotherTimeThanTheComputersAreStale) {
  OwnSender sender({}, 5);
  sender.OnFix(Fix(kStart - 3600000000));
  sender.OnMotion(Motion(kStart));
  EXPECT_FALSE(sender.Step(kStart));
  sender.OnFix(Fix(kStart + 3600000000));
  EXPECT_FALSE(sender.Step(kStart + 100000));
  EXPECT_EQ(sender.state(), OwnState::kNoFix);
}

TEST(OwnSender, AClockSetBackDoesNotSilenceIt) {
  Drive drive;
  drive.Run(1.0);
  const std::size_t before = drive.messages.size();
  drive.now -= 500000;  // Fix and motion stay fresh.
  drive.Run(0.5);
  EXPECT_GE(drive.messages.size(), before + 4);
}

TEST(OwnSender, WhatIsSentAndWhatTheDaemonIsToldAreTheSameMessage) {
  Drive drive;
  drive.Run(1.0);
  for (const OwnSender::Message& message : drive.messages) {
    Octets scratch(kLongestDatagram);
    Datagram datagram;
    ReadDatagram(message.datagram, {std::nullopt, false, 0}, scratch, datagram);
    ASSERT_FALSE(datagram.fault) << FaultText(datagram.fault);
    EXPECT_EQ(datagram.bsm->core.id, BigEndian32(message.bsm.id));
    EXPECT_EQ(datagram.bsm->core.msg_count, message.bsm.msgCnt);
    EXPECT_EQ(datagram.bsm->core.lat, message.bsm.lat);
    EXPECT_EQ(drive.sender.id(), BigEndian32(message.bsm.id));
  }
}

// A unit with a stack of its own: two streams from one car.
TEST(OwnSender, IsSilentWhileTheUnitSendsBsmsOfItsOwn) {
  Drive drive;
  drive.Run(1.0);
  drive.sender.OnUnitSent(drive.sender.id(), drive.now);  // Ours: as it should be.
  drive.Run(1.0);
  EXPECT_EQ(drive.sender.state(), OwnState::kSending);
  drive.sender.OnUnitSent(drive.sender.id() + 1, drive.now);
  const std::size_t before = drive.messages.size();
  drive.Run(9.0);
  EXPECT_EQ(drive.sender.state(), OwnState::kUnitSends);
  EXPECT_EQ(drive.messages.size(), before);
  drive.Run(2.0);
  EXPECT_EQ(drive.sender.state(), OwnState::kSending);
}

}  // namespace
}  // namespace v2vouch::obu
