// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/notice_board.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

using Kind = NoticeSubject::Kind;

NoticeBoard Board() {
  VehicleConfig vehicle;
  vehicle.radars.resize(2);
  vehicle.radars[0].name = "FRONT";
  vehicle.radars[1].name = "LEFT";
  vehicle.cameras.resize(1);
  vehicle.cameras[0].name = "FRONT";
  return NoticeBoard(wire::InputChannels(vehicle, wire::ChannelNames{}));
}

TEST(NoticeBoard, NamesTheChannelOfWhatItIsAbout) {
  NoticeBoard board = Board();
  const std::vector<Notice> notices = {{NoticeKind::kClockAhead, {Kind::kRadar, 1}, 0.9},
                                       {NoticeKind::kClockAhead, {Kind::kSender, 0x1a2b3c4d}, 1.0},
                                       {NoticeKind::kClockAhead, {Kind::kCar, 0}},
                                       {NoticeKind::kInputSilent, {Kind::kCamera, 0}, 2.0}};
  board.Update(notices, FromMicros(7));
  ASSERT_EQ(board.in_force().size(), 4u);
  EXPECT_EQ(board.in_force()[0].channel, "");
  EXPECT_EQ(board.in_force()[1].channel, "RADAR_LEFT");
  EXPECT_EQ(board.in_force()[1].name, "clock_ahead");
  EXPECT_EQ(board.in_force()[1].value, 0.9);
  EXPECT_FALSE(board.in_force()[1].advice.empty());
  EXPECT_EQ(board.in_force()[2].channel, "BSM:1a2b3c4d");
  EXPECT_EQ(board.in_force()[3].channel, "CAMERA_FRONT");
}

TEST(NoticeBoard, KeepsTheBeginningAndTellsBeginAndEndOnce) {
  NoticeBoard board = Board();
  const std::vector<Notice> first = {{NoticeKind::kClockAhead, {Kind::kRadar, 0}, 0.9}};
  const std::vector<Notice> later = {{NoticeKind::kClockAhead, {Kind::kRadar, 0}, 1.1}};
  board.Update(first, FromMicros(1));
  board.Update(later, FromMicros(2));
  ASSERT_EQ(board.in_force().size(), 1u);
  EXPECT_EQ(board.in_force()[0].since, FromMicros(1));
  EXPECT_EQ(board.in_force()[0].value, 1.1);
  auto changes = board.TakeChanges();
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_TRUE(changes[0].has_begun);
  board.Update({}, FromMicros(3));
  EXPECT_TRUE(board.in_force().empty());
  changes = board.TakeChanges();
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_FALSE(changes[0].has_begun);
  EXPECT_EQ(changes[0].notice.channel, "RADAR_FRONT");
}

}  // namespace
}  // namespace v2vouch
