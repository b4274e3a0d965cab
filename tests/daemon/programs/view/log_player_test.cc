// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/view/log_player.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "daemon/rim/wire/codec.h"
#include "tests/daemon/rim/view/view_messages.h"

namespace v2vouch {
namespace {

using std::chrono::milliseconds;
using view::PlaybackState;

constexpr std::int64_t kStart_us = 1'000'000'000;

// A minute of lists, 20 a second; from second 30 on a vehicle is in PRIORITY.
std::string MakeLog(const std::string& name) {
  const std::string path = (std::filesystem::temp_directory_path() / name).string();
  std::string error;
  const auto writer = LogWriter::Create(path, error);
  EXPECT_NE(writer, nullptr) << error;
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i <= 1200; ++i) {
    const std::int64_t t = kStart_us + i * 50'000;
    for (const char* channel : {"TRACKS_LOCAL", "TRACKS_PRIORITY"}) {
      wire::Encode(i < 600 ? view::List(t, {}) : view::List(t, {view::Track(4, 20, 0)}), bytes);
      writer->Write(FromMicros(t), channel, bytes);
    }
  }
  EXPECT_TRUE(writer->Close(error)) << error;
  return path;
}

TEST(LogPlayer, PlaysPausesSeeksAndEnds) {
  view::Scene scene({}, {});
  std::string error;
  const auto player = LogPlayer::Open(
      MakeLog("log_player_test.lcm"), scene, [](double) { return true; }, error);
  ASSERT_NE(player, nullptr) << error;
  EXPECT_TRUE(player->has_lists());
  EXPECT_EQ(player->state().begin_us, kStart_us);
  EXPECT_EQ(player->state().end_us, kStart_us + 60'000'000);
  ASSERT_EQ(scene.events().events().size(), 1u);  // Of the whole drive, before it is played.
  EXPECT_EQ(scene.events().events()[0].at, kStart_us + 30'000'000);

  std::chrono::steady_clock::time_point now{};
  player->Advance(now);
  for (int i = 0; i < 10; ++i) player->Advance(now += milliseconds(100));
  EXPECT_EQ(player->state().now_us, kStart_us + 1'000'000);
  EXPECT_EQ(scene.list_received(), kStart_us + 1'000'000);

  player->Control({false, 1.0, kStart_us + 45'020'000, ""});
  EXPECT_EQ(scene.list_received(), kStart_us + 45'000'000);
  player->Advance(now += milliseconds(100));
  EXPECT_EQ(player->state().now_us, kStart_us + 45'020'000);
  EXPECT_EQ(player->state().status, PlaybackState::Status::kPaused);

  player->Control({false, 1.0, kStart_us + 10'000'000, ""});  // Back.
  EXPECT_EQ(scene.list_received(), kStart_us + 10'000'000);
  EXPECT_TRUE(scene.list(view::Scene::List::kPriority).message->tracks.empty());

  player->Control({true, 50.0, kStart_us + 59'000'000, ""});
  for (int i = 0; i < 5; ++i) player->Advance(now += milliseconds(100));
  EXPECT_EQ(player->state().status, PlaybackState::Status::kEnded);
  EXPECT_EQ(scene.events().events().size(), 1u);  // None a second time.
  player->Control({true, 1.0, std::nullopt, ""});
  EXPECT_EQ(player->state().now_us, kStart_us);
}

TEST(LogPlayer, ARecordersClockThatWasSetBackDoesNotFoldTheDrive) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "log_player_back_test.lcm").string();
  std::string error;
  {
    const auto writer = LogWriter::Create(path, error);
    ASSERT_NE(writer, nullptr) << error;
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i <= 400; ++i) {
      const std::int64_t t = kStart_us + i * 50'000;
      wire::Encode(view::List(t, {}), bytes);
      const std::int64_t set_back = i < 200 ? 0 : 3'600'000'000;  // After ten seconds, an hour.
      writer->Write(FromMicros(t - set_back), "TRACKS_LOCAL", bytes);
    }
    ASSERT_TRUE(writer->Close(error)) << error;
  }
  view::Scene scene({}, {});
  const auto player = LogPlayer::Open(
      path, scene, [](double) { return true; }, error);
  ASSERT_NE(player, nullptr) << error;
  EXPECT_NEAR(static_cast<double>(player->state().end_us - kStart_us), 20e6, 0.1e6);
  for (const std::int64_t second : {15, 5, 18, 11}) {
    player->Control({false, 1.0, kStart_us + second * 1'000'000, ""});
    EXPECT_NEAR(static_cast<double>(scene.list_utime() - kStart_us),
                1e6 * static_cast<double>(second), 0.11e6);
  }
}

TEST(LogPlayer, WhatIsNoLogIsRefusedWithTheReason) {
  view::Scene scene({}, {});
  std::string error;
  EXPECT_EQ(LogPlayer::Open(
                "/dev/null", scene, [](double) { return true; }, error),
            nullptr);
  EXPECT_FALSE(error.empty());
}

}  // namespace
}  // namespace v2vouch
