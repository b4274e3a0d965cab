// SPDX-License-Identifier: Apache-2.0
// What v2vouchd publishes when inputs stop, ego motion is lost, or the daemon itself is stopped for
// a while: over UDP, in a private network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/program.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::Eventually;
using testing::Program;
using testing::WireMessage;

/// A list with the time it was heard at.
struct HeardList {
  double at_s = 0.0;
  track_list_t list;
};

struct Heard {
  std::vector<HeardList> local;
  std::vector<HeardList> priority;
  std::vector<daemon_status_t> statuses;
  std::string words;  ///< The daemon's log.
};

class LiveSilence : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr || std::getenv("V2VOUCH_BIN") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
    bin_ = std::getenv("V2VOUCH_BIN");
    std::string pattern = (fs::temp_directory_path() / "live_silence_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  /// Plays `messages` to the daemon, which is stopped from `stop_at` on for `stop_for`, and listens
  /// on for 3 s more.
  Heard Play(const std::vector<WireMessage>& messages, std::chrono::milliseconds stop_at = 0ms,
             std::chrono::milliseconds stop_for = 0ms) {
    std::string error;
    const auto writer = LogWriter::Create(Path("drive.lcm"), error);
    EXPECT_TRUE(writer) << error;
    for (const WireMessage& message : messages) {
      writer->Write(message.received, message.channel, message.bytes);
    }
    EXPECT_TRUE(writer->Close(error)) << error;
    Program logger({"lcm-logger", "--quiet", "--force", Path("live.lcm")}, Path("logger.txt"));
    Program daemon({bin_ + "/v2vouchd"}, Path("daemon.txt"));
    EXPECT_TRUE(Eventually(
        [&] { return daemon.Output().find("event=started") != std::string::npos; }, 10s));
    Program player({"lcm-logplayer", Path("drive.lcm")}, Path("player.txt"));
    if (stop_for > 0ms) {
      std::this_thread::sleep_for(stop_at);
      daemon.Signal(SIGSTOP);
      std::this_thread::sleep_for(stop_for);
      daemon.Signal(SIGCONT);
    }
    EXPECT_EQ(player.Wait(30s), 0);
    std::this_thread::sleep_for(3s);
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(5s), 0) << daemon.Output();
    logger.Signal(SIGINT);
    static_cast<void>(logger.Wait(5s));

    Heard heard;
    heard.words = daemon.Output();
    const auto reader = LogReader::Open(Path("live.lcm"), error);
    EXPECT_TRUE(reader) << error;
    LogEvent event;
    Timestamp first{};
    while (reader && reader->Next(event)) {
      if (first == Timestamp{}) first = event.received;
      const double at_s = ToSeconds(event.received - first);
      if (event.channel == "TRACKS_LOCAL" || event.channel == "TRACKS_PRIORITY") {
        const auto list = wire::Decode<track_list_t>(event.bytes);
        if (list) {
          (event.channel == "TRACKS_LOCAL" ? heard.local : heard.priority).push_back({at_s, *list});
        }
      } else if (event.channel == "V2VOUCH_STATUS") {
        if (const auto status = wire::Decode<daemon_status_t>(event.bytes)) {
          heard.statuses.push_back(*status);
        }
      }
    }
    return heard;
  }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  std::string bin_;
  fs::path folder_;
};

std::vector<WireMessage> DriveMessages(double duration_s) {
  testing::SyntheticDrive drive;
  drive.duration_s = duration_s;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  return testing::EncodeInputs(testing::MakeInputs(drive), VehicleConfig{});
}

void ExpectTimeNeverGoesBackOrStandsStill(const std::vector<HeardList>& lists) {
  ASSERT_GT(lists.size(), 50u);
  for (std::size_t i = 1; i < lists.size(); ++i) {
    const track_list_t& last = lists[i - 1].list;
    const track_list_t& next = lists[i].list;
    EXPECT_GE(next.utime, last.utime) << "list " << i;
    if (next.stale == 0 && last.stale == 0) {
      EXPECT_TRUE(next.utime > last.utime || next.revision > last.revision) << "list " << i;
    }
  }
}

TEST_F(LiveSilence, OfAllInputsGivesStaleListsThenEmptyOnes) {
  const Heard heard = Play(DriveMessages(3.0));
  ExpectTimeNeverGoesBackOrStandsStill(heard.local);
  ExpectTimeNeverGoesBackOrStandsStill(heard.priority);
  const track_list_t& end = heard.local.back().list;
  EXPECT_EQ(end.stale, 1);
  EXPECT_EQ(end.num_tracks, 0);
  const auto stale =
      std::ranges::find_if(heard.local, [](const HeardList& each) { return each.list.stale == 1; });
  ASSERT_NE(stale, heard.local.end());
  EXPECT_GE(stale->list.num_tracks, 1);
  EXPECT_THAT(heard.words, ::testing::HasSubstr("event=input_silent channel=RADAR_FRONT"));
}

TEST_F(LiveSilence, OfEgoMotionAloneIsNamedAndNeverLooksFresh) {
  std::vector<WireMessage> messages = DriveMessages(5.0);
  const Timestamp from = messages.front().received + 2s;
  std::erase_if(messages, [&](const WireMessage& message) {
    return message.channel == "EGO_MOTION" && message.received >= from;
  });
  const Heard heard = Play(messages);
  ExpectTimeNeverGoesBackOrStandsStill(heard.local);
  ExpectTimeNeverGoesBackOrStandsStill(heard.priority);
  // Frames go on for 3 s; half a second of them can still be placed.
  const auto last_fresh =
      std::ranges::find_if(heard.local.rbegin(), heard.local.rend(),
                           [](const HeardList& each) { return each.list.stale == 0; });
  ASSERT_NE(last_fresh, heard.local.rend());
  const auto first_stale = std::ranges::find_if(heard.local, [&](const HeardList& each) {
    return each.list.stale == 1 && each.at_s > last_fresh->at_s;
  });
  ASSERT_NE(first_stale, heard.local.end());
  EXPECT_LE(first_stale->at_s, last_fresh->at_s + 0.5);
  const bool is_named = std::ranges::any_of(heard.statuses, [](const daemon_status_t& status) {
    return std::ranges::any_of(status.notices, [](const notice_t& notice) {
      return notice.name == "input_silent" && notice.channel == "EGO_MOTION";
    });
  });
  EXPECT_TRUE(is_named);
  EXPECT_THAT(heard.words, ::testing::HasSubstr("event=input_silent channel=EGO_MOTION"));
}

TEST_F(LiveSilence, OfTheDaemonItselfLetsPublishedTimeNeverGoBack) {
  const Heard heard = Play(DriveMessages(6.0), 2000ms, 1500ms);
  ExpectTimeNeverGoesBackOrStandsStill(heard.local);
  ExpectTimeNeverGoesBackOrStandsStill(heard.priority);
  // The end of the drive is published, and fresh.
  const auto fresh = std::ranges::count_if(
      heard.local, [](const HeardList& each) { return each.list.stale == 0; });
  EXPECT_GT(fresh, 150);
}

}  // namespace
}  // namespace v2vouch
