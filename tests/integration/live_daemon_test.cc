// SPDX-License-Identifier: Apache-2.0
// v2vouchd over UDP, beside Debian's own lcm-logplayer and lcm-logger, in a private network.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/program.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::Eventually;
using ::testing::HasSubstr;
using testing::Program;
using testing::WireMessage;
using Bytes = std::vector<std::uint8_t>;

class LiveDaemon : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr || std::getenv("V2VOUCH_BIN") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
    bin_ = std::getenv("V2VOUCH_BIN");
    std::string pattern = (fs::temp_directory_path() / "live_daemon_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  [[nodiscard]] std::string Path(const std::string& name) const {
    return (folder_ / name).string();
  }

  std::unique_ptr<Program> StartDaemon() {
    auto daemon =
        std::make_unique<Program>(std::vector<std::string>{bin_ + "/v2vouchd"}, Path("daemon.txt"));
    EXPECT_TRUE(Eventually(
        [&] { return daemon->Output().find("event=started") != std::string::npos; }, 10s))
        << daemon->Output();
    return daemon;
  }

  // Ends it as systemd would, and gives its last words.
  static std::string Stop(Program& daemon) {
    daemon.Signal(SIGTERM);
    EXPECT_EQ(daemon.Wait(5s), 0) << daemon.Output();
    EXPECT_THAT(daemon.Output(), HasSubstr("event=stopped"));
    return daemon.Output();
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

void WriteLog(const std::string& path, const std::vector<WireMessage>& messages) {
  std::string error;
  const auto writer = LogWriter::Create(path, error);
  ASSERT_TRUE(writer) << error;
  for (const WireMessage& message : messages) {
    writer->Write(message.received, message.channel, message.bytes);
  }
  ASSERT_TRUE(writer->Close(error)) << error;
}

// The value behind `key=` in the daemon's last words.
std::string Word(const std::string& text, const std::string& key) {
  const auto start = text.rfind(key + "=");
  if (start == std::string::npos) return "";
  const auto from = start + key.size() + 1;
  return text.substr(from, text.find_first_of(" \n", from) - from);
}

// Collects the newest status.
class StatusListener {
 public:
  StatusListener() : bus_(LcmBus::Open("")) {
    EXPECT_TRUE(bus_);
    bus_->Subscribe("V2VOUCH_STATUS",
                    [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                      if (auto status = wire::Decode<daemon_status_t>(bytes)) newest_ = *status;
                    });
  }
  LcmBus& bus() { return *bus_; }
  bool Until(const std::function<bool(const daemon_status_t&)>& condition) {
    return Eventually(
        [&] {
          while (bus_->Handle(1)) {
            if (newest_.seq != seen_) break;
            if (++rounds_ % 20 == 0) break;
          }
          seen_ = newest_.seq;
          return newest_.seq > 0 && condition(newest_);
        },
        10s);
  }
  [[nodiscard]] std::map<std::string, std::int64_t> Refusals() const {
    std::map<std::string, std::int64_t> refusals;
    for (const count_t& refusal : newest_.refusals) refusals[refusal.name] = refusal.count;
    return refusals;
  }

 private:
  std::unique_ptr<LcmBus> bus_;
  daemon_status_t newest_{};
  std::int64_t seen_ = 0;
  int rounds_ = 0;
};

// A calibration that cannot be trusted must not be run on, nor quietly run without.
TEST_F(LiveDaemon, ABadCalibrationEndsEveryProgramWithCode2) {
  std::ofstream(Path("vehicle.yaml")) << "calibration: broken.yaml\n";
  std::ofstream(Path("broken.yaml")) << "version: 1\n";
  WriteLog(Path("drive.lcm"), DriveMessages(0.2));
  const std::vector<std::vector<std::string>> programs = {
      {bin_ + "/v2vouchd", "--config", Path("vehicle.yaml")},
      {bin_ + "/v2vouch-replay", Path("drive.lcm"), "--out", Path("out.lcm"), "--config",
       Path("vehicle.yaml")}};
  for (const auto& arguments : programs) {
    Program program(arguments, Path("words.txt"));
    EXPECT_EQ(program.Wait(10s), 2);
    EXPECT_THAT(program.Output(), HasSubstr("broken.yaml: does not end in a checksum line"));
  }
  EXPECT_FALSE(fs::exists(Path("out.lcm")));
}

TEST_F(LiveDaemon, FedByLcmLogplayerGivesTheDigestsOfTheReplay) {
  WriteLog(Path("drive.lcm"), DriveMessages(3.0));
  Program replay(
      {bin_ + "/v2vouch-replay", Path("drive.lcm"), "--out", Path("replay.lcm"), "--json"},
      Path("replay.json"));
  ASSERT_EQ(replay.Wait(20s), 0) << replay.Output();
  const auto offline = nlohmann::json::parse(replay.Output());
  ASSERT_GT(offline["lists"], 100);

  Program logger({"lcm-logger", "--quiet", "--force", Path("live.lcm")}, Path("logger.txt"));
  const auto daemon = StartDaemon();
  Program player({"lcm-logplayer", Path("drive.lcm")}, Path("player.txt"));
  ASSERT_EQ(player.Wait(20s), 0) << player.Output();
  std::this_thread::sleep_for(300ms);  // What is still on its way.
  const std::string words = Stop(*daemon);
  ASSERT_EQ(Word(words, "accepted"), std::to_string(offline["accepted"].get<int>())) << words;
  EXPECT_EQ(Word(words, "digest_local"), offline["digest_local"].get<std::string>());
  EXPECT_EQ(Word(words, "digest_priority"), offline["digest_priority"].get<std::string>());

  logger.Signal(SIGINT);
  static_cast<void>(logger.Wait(5s));
  std::map<std::string, int> recorded;
  std::string error;
  const auto reader = LogReader::Open(Path("live.lcm"), error);
  ASSERT_TRUE(reader) << error;
  LogEvent event;
  while (reader->Next(event)) ++recorded[event.channel];
  // On a machine that lags, predicted copies go out first, and published time does not go back.
  EXPECT_GE(recorded["TRACKS_LOCAL"] + std::atoi(Word(words, "withheld_lists").c_str()),
            offline["lists"].get<int>());
  EXPECT_GE(recorded["V2VOUCH_STATUS"], 2);
  EXPECT_EQ(recorded["V2VOUCH_CONFIG"], 1);
}

// A datagram as it stands, past LCM's own encoder.
void SendRaw(const Bytes& datagram) {
  int port = 7667;
  if (const char* url = std::getenv("LCM_DEFAULT_URL")) {
    const std::string text = url;
    const auto colon = text.find(':', text.find("//") + 2);
    if (colon != std::string::npos) port = std::atoi(text.c_str() + colon + 1);
  }
  const int out = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, "239.255.76.67", &to.sin_addr);
  sendto(out, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
         sizeof(to));
  close(out);
}

Bytes WithInt32(Bytes bytes, std::size_t at, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes.at(at + i) = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * i));
  }
  return bytes;
}

Bytes GoodScan() {
  radar_scan_t scan{};
  scan.utime = 1'700'000'000'000'000;
  scan.sensor = "FRONT";
  scan.detections.resize(2);
  scan.num_detections = 2;
  for (auto& detection : scan.detections) detection.range_m = 10.0;
  Bytes bytes;
  wire::Encode(scan, bytes);
  return bytes;
}

TEST_F(LiveDaemon, HostilePacketsAreCountedAndSurvived) {
  const auto daemon = StartDaemon();
  StatusListener listener;
  const Bytes good = GoodScan();
  constexpr std::size_t kName = 24;
  constexpr std::size_t kCount = kName + 4 + 6;
  const auto send = [&](const Bytes& bytes) { listener.bus().Publish("RADAR_FRONT", bytes); };

  Bytes wrong_type = good;
  wrong_type[0] ^= 0xFF;
  send(wrong_type);
  send({});
  send(Bytes(good.begin(), good.begin() + 4));
  send(Bytes(good.begin(), good.end() - 1));
  Bytes trailing = good;
  trailing.push_back(7);
  send(trailing);
  for (const std::int32_t count : {-1, 0x7FFFFFFF, 100'000'000}) {
    send(WithInt32(good, kCount, count));
  }
  for (const std::int32_t length : {0, -1, INT32_MIN, 0x7FFFFFFF}) {
    send(WithInt32(good, kName, length));
  }
  send(Bytes(200'000, 1));
  Bytes not_a_number = good;
  std::fill_n(not_a_number.begin() + kCount + 4, 8, std::uint8_t{0xFF});
  send(not_a_number);
  Bytes of_another = good;
  of_another[kName + 4] = 'X';
  send(of_another);

  SendRaw({});
  SendRaw({0x4C, 0x43, 0x30, 0x32, 0, 0, 0, 1});  // A bare short header.
  SendRaw({0xDE, 0xAD, 0xBE, 0xEF, 0, 0, 0, 1, 'A', 0});
  Bytes long_name = {0x4C, 0x43, 0x30, 0x32, 0, 0, 0, 2};
  long_name.insert(long_name.end(), 64, 'A');
  long_name.push_back(0);
  SendRaw(long_name);

  EXPECT_TRUE(listener.Until([&](const daemon_status_t&) {
    const auto refusals = listener.Refusals();
    for (const char* reason : {"wrong_type", "too_short", "trailing_bytes", "bad_length",
                               "bad_string", "too_large", "not_finite", "sensor_mismatch"}) {
      if (!refusals.contains(reason)) return false;
    }
    return refusals.at("bad_length") >= 3 && refusals.at("bad_string") >= 4;
  })) << ::testing::PrintToString(listener.Refusals());
  EXPECT_TRUE(daemon->IsRunning());

  // And it still works.
  for (const WireMessage& message : DriveMessages(0.5)) {
    listener.bus().Publish(message.channel, message.bytes);
  }
  EXPECT_TRUE(
      listener.Until([](const daemon_status_t& status) { return status.digest_inputs > 20; }));
  Stop(*daemon);
}

TEST_F(LiveDaemon, StatusTellsTheGrantedReceiveBufferAndKernelDrops) {
  const auto daemon = StartDaemon();
  StatusListener listener;
  EXPECT_TRUE(listener.Until([](const daemon_status_t& status) {
    return status.receive_buffer_bytes > 0 && status.kernel_drops >= 0;
  }));
  Stop(*daemon);
}

TEST_F(LiveDaemon, SilenceGivesStaleListsOnceSomethingWasSeen) {
  const auto daemon = StartDaemon();
  StatusListener listener;
  for (const WireMessage& message : DriveMessages(0.5)) {
    listener.bus().Publish(message.channel, message.bytes);
  }
  std::this_thread::sleep_for(600ms);
  const std::string words = Stop(*daemon);
  EXPECT_GT(std::atoi(Word(words, "stale_lists").c_str()), 2) << words;
}

TEST_F(LiveDaemon, StartsBeforeThereIsARouteAndRecovers) {
  if (std::string(std::getenv("V2VOUCH_PRIVATE_LCM")) != "namespace") {
    GTEST_SKIP() << "SKIPPED: no network namespace of our own, so routes are not ours to remove";
  }
  ASSERT_EQ(std::system("ip route del 224.0.0.0/4 dev lo"), 0);
  Program daemon({bin_ + "/v2vouchd"}, Path("daemon.txt"));
  EXPECT_TRUE(
      Eventually([&] { return daemon.Output().find("event=no_lcm") != std::string::npos; }, 10s))
      << daemon.Output();
  ASSERT_EQ(std::system("ip route add 224.0.0.0/4 dev lo"), 0);
  EXPECT_TRUE(
      Eventually([&] { return daemon.Output().find("event=started") != std::string::npos; }, 10s))
      << daemon.Output();
  Stop(daemon);
}

TEST_F(LiveDaemon, ConfigurationErrorsAreAllNamedAndExitTwo) {
  std::ofstream(Path("bad.yaml")) << "timeline:\n  future_s: -1\nradars: 3\n";
  Program daemon({bin_ + "/v2vouchd", "--config", Path("bad.yaml"), "-l", "carrier://pigeon"},
                 Path("daemon.txt"));
  EXPECT_EQ(daemon.Wait(10s), 2);
  EXPECT_THAT(daemon.Output(), HasSubstr("timeline.future_s = -1: must be above 0.1, at most 60"));
  EXPECT_THAT(daemon.Output(), HasSubstr("radars: unknown key"));
  EXPECT_THAT(daemon.Output(), HasSubstr("unknown provider"));
}

}  // namespace
}  // namespace v2vouch
