// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/replay/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon/rim/io/event_log.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::WireMessage;

class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    std::string pattern = (fs::temp_directory_path() / "replay_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~ReplayTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  std::string Save(const std::string& name, const std::vector<WireMessage>& messages) const {
    std::string error;
    const auto writer = LogWriter::Create(Path(name), error);
    for (const WireMessage& message : messages) {
      writer->Write(message.received, message.channel, message.bytes);
    }
    EXPECT_TRUE(writer->Close(error)) << error;
    return Path(name);
  }

  fs::path folder_;
};

std::vector<WireMessage> Drive() {
  testing::SyntheticDrive drive;
  drive.duration_s = 2.0;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  return testing::EncodeInputs(testing::MakeInputs(drive), VehicleConfig{});
}

std::vector<LogEvent> Events(const std::string& path) {
  std::string error;
  const auto reader = LogReader::Open(path, error);
  EXPECT_TRUE(reader) << error;
  std::vector<LogEvent> events;
  for (LogEvent event; reader && reader->Next(event);) events.push_back(event);
  return events;
}

ReplayResult RunLog(const std::string& in, const std::string& out) {
  ReplayResult result;
  std::string error;
  EXPECT_TRUE(Replay(
      in, out, DaemonConfig{}, [](double) { return true; }, result, error))
      << error;
  return result;
}

// A log of slow steps, full radars say, must not go on for seconds.
TEST_F(ReplayTest, StopsBeforeTheNextEventWhereItIsAsked) {
  const std::string in = Save("in.lcm", Drive());
  ReplayResult result;
  std::string error;
  int asked = 0;
  EXPECT_FALSE(Replay(
      in, Path("out.lcm"), DaemonConfig{}, [&](double) { return ++asked < 10; }, result, error));
  EXPECT_EQ(error, "stopped");
  EXPECT_EQ(result.events, 10);
}

TEST_F(ReplayTest, OutputHoldsAllEventsAndEachOutputBehindItsCause) {
  auto messages = Drive();
  messages.insert(messages.begin() + 5, {"TRUTH", {1, 2, 3}, messages[5].received});
  const std::string in = Save("in.lcm", messages);
  const ReplayResult result = RunLog(in, Path("out.lcm"));
  EXPECT_EQ(result.events, static_cast<std::int64_t>(messages.size()));
  EXPECT_EQ(result.copied, 1);
  EXPECT_EQ(result.accepted, result.inputs);
  EXPECT_GT(result.lists, 50);

  std::size_t next = 0;
  std::int64_t local_lists = 0;
  for (const LogEvent& event : Events(Path("out.lcm"))) {
    if (next < messages.size() && event.channel == messages[next].channel &&
        event.bytes == messages[next].bytes) {
      ++next;
    } else {
      const Timestamp cause = messages[next == 0 ? 0 : next - 1].received;
      EXPECT_EQ(event.received, cause) << event.channel;
    }
    if (event.channel == "TRACKS_LOCAL") ++local_lists;
  }
  EXPECT_EQ(next, messages.size());
  EXPECT_EQ(local_lists, result.lists);
}

TEST_F(ReplayTest, RunsAreRepeatableAndReplayOfAReplayIsTheSame) {
  const std::string in = Save("in.lcm", Drive());
  const ReplayResult first = RunLog(in, Path("a.lcm"));
  RunLog(in, Path("b.lcm"));
  const auto a = Events(Path("a.lcm"));
  const auto b = Events(Path("b.lcm"));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].bytes, b[i].bytes) << a[i].channel;
  const ReplayResult again = RunLog(Path("a.lcm"), Path("c.lcm"));
  EXPECT_GT(again.old_outputs, 0);
  EXPECT_EQ(again.digest_local, first.digest_local);
  EXPECT_EQ(again.digest_priority, first.digest_priority);
  EXPECT_EQ(Events(Path("c.lcm")).size(), a.size());
}

TEST_F(ReplayTest, LocalDigestKnowsNeitherBsmNorTruthNorGnss) {
  const ReplayResult whole = RunLog(Save("whole.lcm", Drive()), "");
  std::vector<WireMessage> own;
  for (const WireMessage& message : Drive()) {
    if (message.channel != "BSM" && message.channel != "EGO_GNSS") own.push_back(message);
  }
  EXPECT_EQ(RunLog(Save("own.lcm", own), "").digest_local, whole.digest_local);
}

TEST_F(ReplayTest, FilesThatCannotBeUsedSayWhy) {
  ReplayResult result;
  std::string error;
  const auto go_on = [](double) { return true; };
  EXPECT_FALSE(Replay(Path("none.lcm"), "", DaemonConfig{}, go_on, result, error));
  EXPECT_THAT(error, ::testing::HasSubstr("No such file"));
  const std::string in = Save("in.lcm", Drive());
  EXPECT_FALSE(Replay(in, in, DaemonConfig{}, go_on, result, error));
  EXPECT_THAT(error, ::testing::HasSubstr("is the file that is being read"));
  EXPECT_FALSE(Replay(in, Path("no/folder/out.lcm"), DaemonConfig{}, go_on, result, error));
}

// The drive with channels renamed; "" leaves a message out.
std::vector<WireMessage> Renamed(const std::map<std::string, std::string>& names) {
  std::vector<WireMessage> messages;
  for (WireMessage message : Drive()) {
    const auto found = names.find(message.channel);
    if (found != names.end()) message.channel = found->second;
    if (!message.channel.empty()) messages.push_back(message);
  }
  return messages;
}

TEST_F(ReplayTest, AMistypedChannelIsToldWithTheOneThatWasMeant) {
  const ReplayResult result = RunLog(Save("in.lcm", Renamed({{"RADAR_FRONT", "RADAR_FORNT"}})), "");
  EXPECT_THAT(result.verdict.problems, IsEmpty());  // The others make lists.
  EXPECT_THAT(
      result.verdict.notes,
      AllOf(Contains(AllOf(HasSubstr("RADAR_FORNT: "), HasSubstr("no such sensor"),
                           HasSubstr("(did you mean RADAR_FRONT?)"))),
            Contains(HasSubstr("RADAR_FRONT: not in the log (did you mean RADAR_FORNT?)"))));
  EXPECT_GT(result.lists, 0);
  EXPECT_THAT(RunLog(Save("good.lcm", Drive()), "").verdict.notes,
              Not(Contains(HasSubstr("RADAR"))));
}

TEST_F(ReplayTest, ALogOfWhichNothingComesIsAProblemThatSaysWhy) {
  const auto problems = [&](const std::vector<WireMessage>& messages) {
    const ReplayResult result = RunLog(Save("in.lcm", messages), "");
    EXPECT_EQ(result.lists, 0);
    return result.verdict.problems;
  };
  std::vector<WireMessage> foreign = Drive();
  for (WireMessage& message : foreign) message.channel = "LIDAR_TOP";
  EXPECT_THAT(problems(foreign),
              ElementsAre(AllOf(HasSubstr("no event is on a channel"), HasSubstr("EGO_MOTION"),
                                HasSubstr("LIDAR_TOP"))));
  EXPECT_THAT(problems(Renamed({{"EGO_MOTION", "EGOMOTION"}})),
              Contains(AllOf(HasSubstr("without an accepted message on EGO_MOTION"),
                             HasSubstr("did you mean EGOMOTION?"))));
  std::vector<WireMessage> broken = Drive();
  for (WireMessage& message : broken) message.bytes.resize(5);
  EXPECT_THAT(problems(broken), Contains(AllOf(HasSubstr("none of"), HasSubstr("was accepted"),
                                               HasSubstr("too_short"))));
  EXPECT_THAT(problems(Renamed({{"RADAR_FRONT", ""},
                                {"RADAR_FRONT_LEFT", ""},
                                {"RADAR_FRONT_RIGHT", ""},
                                {"CAMERA_FRONT", ""}})),
              Contains(HasSubstr("no scan or picture")));
}

TEST_F(ReplayTest, ACameraWhoseOtherChannelIsFilledIsTold) {
  const ReplayResult result =
      RunLog(Save("in.lcm", Renamed({{"CAMERA_FRONT", "CAMERA_FRONT_DETECTED"}})), "");
  EXPECT_THAT(result.verdict.notes, Contains(HasSubstr("source: detected takes those")));
}

TEST(TextReport, AStatisticOfNothingIsNone) {
  const ReplayResult result;
  EXPECT_THAT(TextReport(result),
              AllOf(HasSubstr("step p50              none"), Not(HasSubstr("nan"))));
  EXPECT_TRUE(nlohmann::json::parse(JsonReport(result))["step_us"]["p50"].is_null());
}

TEST(JsonReport, HasTheContractsShape) {
  ReplayResult result;
  result.events = 10;
  result.log_seconds = 20.0;
  result.wall_seconds = 0.1;
  for (int i = 1; i <= 100; ++i) result.step_us.push_back(i);
  result.refused[static_cast<std::size_t>(Reason::kBsmRange)] = 3;
  result.digest_local = "ab";
  const auto json = nlohmann::json::parse(JsonReport(result));
  EXPECT_EQ(json["events"], 10);
  EXPECT_NEAR(json["realtime_factor"].get<double>(), 200.0, 1e-9);
  EXPECT_EQ(json["step_us"]["p50"], 50.0);
  EXPECT_EQ(json["step_us"]["p99"], 99.0);
  EXPECT_EQ(json["step_us"]["max"], 100.0);
  EXPECT_EQ(json["refused"], nlohmann::json({{"bsm_range", 3}}));
  EXPECT_EQ(json["digest_local"], "ab");
  EXPECT_TRUE(json.contains("log_seconds") && json.contains("wall_seconds") &&
              json.contains("digest_priority"));
}

}  // namespace
}  // namespace v2vouch
