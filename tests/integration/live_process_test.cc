// SPDX-License-Identifier: Apache-2.0
// v2vouchd as a process among others: where its words go, who else speaks, what outlives it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

#include "daemon/rim/engine/engine.h"
#include "daemon/rim/engine/trust_file.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/played_drive.h"
#include "tests/integration/program.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::DigestOf;
using testing::DriveMessages;
using testing::Eventually;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Play;
using testing::Program;
using testing::WireMessage;

std::string TextOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Hears the daemon's status on a thread of its own.
class StatusListener {
 public:
  StatusListener() : bus_(LcmBus::Open("")) {
    bus_->Subscribe("V2VOUCH_STATUS",
                    [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                      if (auto status = wire::Decode<daemon_status_t>(bytes)) {
                        const std::lock_guard lock(mutex_);
                        newest_ = *status;
                        ++count_;
                      }
                    });
    thread_ = std::thread([this] {
      while (!is_over_) bus_->Handle(20);
    });
  }
  ~StatusListener() {
    is_over_ = true;
    thread_.join();
  }
  LcmBus& bus() { return *bus_; }
  [[nodiscard]] daemon_status_t newest() {
    const std::lock_guard lock(mutex_);
    return newest_;
  }
  [[nodiscard]] int count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  std::unique_ptr<LcmBus> bus_;
  std::mutex mutex_;
  daemon_status_t newest_{};
  int count_ = 0;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

class LiveProcess : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr || std::getenv("V2VOUCH_BIN") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
    daemon_ = std::string(std::getenv("V2VOUCH_BIN")) + "/v2vouchd";
    std::string pattern = (fs::temp_directory_path() / "live_process_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }

  // The daemon as a shell's user starts it: `redirections` behind its name.
  [[nodiscard]] std::unique_ptr<Program> Start(const std::string& redirections) const {
    return std::make_unique<Program>(
        std::vector<std::string>{
            "/bin/bash", "-c",
            "cd " + folder_.string() + " && exec " + daemon_ + " " + redirections},
        Path("words.txt"));
  }

  // Counts the lists of LOCAL that are no predicted copies, and those with a track.
  LcmBus* ListenToLists() {
    lists_ = LcmBus::Open("");
    lists_->Subscribe("TRACKS_LOCAL",
                      [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                        const auto list = wire::Decode<track_list_t>(bytes);
                        if (!list || list->stale != 0) return;
                        ++valid_;
                        if (list->num_tracks > 0) ++tracks_;
                      });
    listener_ = std::thread([this] {
      while (!is_over_) lists_->Handle(20);
    });
    return lists_.get();
  }
  void StopListening() {
    is_over_ = true;
    listener_.join();
  }

  std::string daemon_;
  fs::path folder_;
  std::atomic<int> valid_ = 0;
  std::atomic<int> tracks_ = 0;

 private:
  std::unique_ptr<LcmBus> lists_;
  std::atomic<bool> is_over_ = false;
  std::thread listener_;
};

TEST_F(LiveProcess, PerceptionGoesOnWhereverStderrLeads) {
  const std::vector<WireMessage> messages = DriveMessages(2.5);
  const std::string expected = DigestOf(messages);
  // A pipe that is full to the brim and that nobody empties.
  ASSERT_EQ(mkfifo(Path("full_pipe").c_str(), 0600), 0);
  const int full_pipe = open(Path("full_pipe").c_str(), O_RDWR | O_NONBLOCK);
  const std::vector<char> water(4096, '.');
  while (write(full_pipe, water.data(), water.size()) > 0) {
  }
  for (const std::string redirections :
       {">/dev/full 2>&1", ">&- 2>&-", "<&- >&- 2>&-", "2> >(exit 0)", "2>full_pipe"}) {
    StatusListener listener;
    const auto daemon = Start(redirections);
    ASSERT_TRUE(Eventually([&] { return listener.count() > 0; }, 10s)) << redirections;
    Play(listener.bus(), messages);
    EXPECT_TRUE(Eventually(
        [&] { return listener.newest().digest_local == expected || !daemon->IsRunning(); }, 5s))
        << redirections;
    daemon->Signal(SIGTERM);
    EXPECT_EQ(daemon->Wait(2s), 0) << redirections;
  }
  close(full_pipe);
}

TEST_F(LiveProcess, ASecondDaemonIsNoticedByBothAndItsEndToo) {
  StatusListener listener;
  const auto first = Start("2>" + Path("first.txt"));
  ASSERT_TRUE(Eventually([&] { return listener.count() > 0; }, 10s));
  std::this_thread::sleep_for(2500ms);
  EXPECT_THAT(TextOf(Path("first.txt")), Not(HasSubstr("foreign_outputs")));
  const auto second = Start("2>" + Path("second.txt"));
  for (const char* file : {"first.txt", "second.txt"}) {
    EXPECT_TRUE(Eventually(
        [&] { return TextOf(Path(file)).find("event=foreign_outputs ") != std::string::npos; }, 8s))
        << TextOf(Path(file));
  }
  second->Signal(SIGTERM);
  EXPECT_EQ(second->Wait(3s), 0);
  EXPECT_TRUE(Eventually(
      [&] {
        return TextOf(Path("first.txt")).find("event=foreign_outputs_ended") != std::string::npos;
      },
      8s))
      << TextOf(Path("first.txt"));
  first->Signal(SIGTERM);
  EXPECT_EQ(first->Wait(3s), 0);
}

// LCM's sending socket has the stock buffer and is not meant.
TEST_F(LiveProcess, StatusTellsTheBufferOfTheReceivingSocket) {
  constexpr int kAsked = 1 << 20;
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  setsockopt(probe, SOL_SOCKET, SO_RCVBUF, &kAsked, sizeof(kAsked));
  int granted = 0;
  socklen_t length = sizeof(granted);
  getsockopt(probe, SOL_SOCKET, SO_RCVBUF, &granted, &length);
  close(probe);
  std::string url = std::getenv("LCM_DEFAULT_URL");
  url = url.substr(0, url.find('?')) + "?ttl=0&recv_buf_size=" + std::to_string(kAsked);
  StatusListener listener;
  const auto daemon = Start("-l '" + url + "' 2>/dev/null");
  EXPECT_TRUE(Eventually([&] { return listener.newest().receive_buffer_bytes == granted; }, 10s))
      << listener.newest().receive_buffer_bytes << " of " << granted;
  daemon->Signal(SIGTERM);
  EXPECT_EQ(daemon->Wait(3s), 0);
}

TEST_F(LiveProcess, PenaltiesOutliveTheDaemonAndTheSwitchTurnsThatOff) {
  TrustFile file;
  file.saved = FromMicros(std::chrono::duration_cast<std::chrono::microseconds>(
                              std::chrono::system_clock::now().time_since_epoch())
                              .count());
  file.senders.push_back({.sender = 0xABCD, .state = TrustState::kRevoked, .accusations = 3});
  const std::string state = Path("trust.state");
  const auto run = [&](const std::string& arguments) {
    StatusListener listener;
    const auto daemon = Start(arguments + " 2>" + Path("daemon.txt"));
    EXPECT_TRUE(Eventually([&] { return listener.count() > 0; }, 10s)) << arguments;
    daemon->Signal(SIGTERM);
    EXPECT_EQ(daemon->Wait(3s), 0);
    return TextOf(Path("daemon.txt"));
  };
  std::ofstream(state) << PrintTrust(file);
  EXPECT_THAT(run("--state " + state), HasSubstr("senders=1 penalties=1"));
  EXPECT_THAT(run("--state " + state), HasSubstr("senders=1 penalties=1"));
  EXPECT_THAT(TextOf(state), HasSubstr("0000abcd 0000000000000000 REVOKED 0 3"));
  EXPECT_THAT(run("--state " + state + " --no-state"), HasSubstr("event=state_off"));

  // Found where systemd says.
  setenv("STATE_DIRECTORY", folder_.c_str(), 1);
  EXPECT_THAT(run(""), HasSubstr("senders=1 penalties=1"));
  unsetenv("STATE_DIRECTORY");
  EXPECT_THAT(run(""), HasSubstr("event=state_off"));

  // Damaged: said, and started without. A file that is none of ours stays what it is.
  std::string damaged = PrintTrust(file);
  damaged[damaged.size() / 2] ^= 1;
  std::ofstream(state, std::ios::trunc) << damaged;
  EXPECT_THAT(run("--state " + state), HasSubstr("is damaged"));
  std::ofstream(state, std::ios::trunc) << "timeline:\n  future_s: 1\n";
  EXPECT_THAT(run("--state " + state), HasSubstr("is no trust file"));
  EXPECT_EQ(TextOf(state), "timeline:\n  future_s: 1\n");
}

// What a service manager hears: a datagram socket like systemd's.
class Manager {
 public:
  explicit Manager(const std::string& path) : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Manager() { close(socket_); }
  // Everything that has come so far.
  std::string Heard() {
    std::array<char, 512> buffer{};
    ssize_t got = 0;
    while ((got = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
      heard_.append(buffer.data(), static_cast<std::size_t>(got)) += '\n';
    }
    return heard_;
  }
  int Count(const std::string& word) {
    const std::string heard = Heard();
    int count = 0;
    for (auto at = heard.find(word); at != std::string::npos; at = heard.find(word, at + 1)) {
      ++count;
    }
    return count;
  }

 private:
  int socket_;
  std::string heard_;
};

TEST_F(LiveProcess, TheServiceManagerIsToldAndTheWatchdogFedWithoutAnyInput) {
  Manager manager(Path("notify"));
  setenv("NOTIFY_SOCKET", Path("notify").c_str(), 1);
  setenv("WATCHDOG_USEC", "400000", 1);
  const auto daemon = Start("2>" + Path("words.log"));
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  EXPECT_TRUE(Eventually([&] { return manager.Count("WATCHDOG=1") > 12; }, 5s)) << manager.Heard();
  EXPECT_EQ(manager.Count("READY=1"), 1);
  // SIGHUP does not end it, and says what to do.
  daemon->Signal(SIGHUP);
  EXPECT_TRUE(Eventually(
      [&] { return TextOf(Path("words.log")).find("restart me") != std::string::npos; }, 3s));
  const int before = manager.Count("WATCHDOG=1");
  EXPECT_TRUE(Eventually([&] { return manager.Count("WATCHDOG=1") > before + 2; }, 2s));
  daemon->Signal(SIGTERM);
  EXPECT_EQ(daemon->Wait(3s), 0);
  EXPECT_EQ(manager.Count("STOPPING=1"), 1);
}

// Restarted as the unit file does it: at once after a pause of 200 ms.
TEST_F(LiveProcess, ValidListsComeWithinASecondAfterAKill) {
  LcmBus& bus = *ListenToLists();
  std::atomic<bool> is_over = false;
  std::thread player([&] {
    const std::vector<WireMessage> messages = DriveMessages(12.0);
    const auto start = std::chrono::steady_clock::now();
    for (const WireMessage& message : messages) {
      if (is_over) return;
      std::this_thread::sleep_until(start + (message.received - testing::DriveStart()));
      bus.Publish(message.channel, message.bytes);
    }
  });
  auto daemon = Start("2>/dev/null");
  EXPECT_TRUE(Eventually([&] { return tracks_ > 0; }, 8s));
  daemon->Signal(SIGKILL);
  daemon->Wait(1s);
  const auto killed = std::chrono::steady_clock::now();
  valid_ = 0;
  tracks_ = 0;
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - killed).count();
  };
  std::this_thread::sleep_for(200ms);
  daemon = Start("2>/dev/null");
  EXPECT_TRUE(Eventually([&] { return valid_ > 0; }, 5s));
  const double valid_s = since();
  EXPECT_TRUE(Eventually([&] { return tracks_ > 0; }, 5s));
  std::printf("valid list %.2f s, the car ahead in it %.2f s after SIGKILL\n", valid_s, since());
  EXPECT_LT(valid_s, 2.0);  // Measured: 0.5 to 0.8 s, the pause of 0.2 s included.
  is_over = true;
  player.join();
  StopListening();
  daemon->Signal(SIGTERM);
  EXPECT_EQ(daemon->Wait(3s), 0);
}

TEST_F(LiveProcess, AWrongUrlEndsWithCode2AndWordsWhereverItStands) {
  const auto words_of = [&](const std::string& arguments) {
    const auto daemon = Start(arguments);
    EXPECT_EQ(daemon->Wait(5s), 2) << arguments;
    return daemon->Output();
  };
  EXPECT_THAT(words_of("-l tcpq://"), HasSubstr("names no host"));
  EXPECT_THAT(words_of("-l udpm://239.255.76.67"), HasSubstr("has no port"));
  EXPECT_THAT(words_of("-l udpm://nonsense:7667"), HasSubstr("must be a multicast address"));
  EXPECT_THAT(words_of("--v2v-lcm-url udpm://239.255.76.67:0"), HasSubstr("from 1 to 65535"));
  std::ofstream(Path("vehicle.yaml")) << "lcm:\n  v2v_url: 'udpm://239.255.76.67:7668?tll=0'\n";
  EXPECT_THAT(words_of("--config " + Path("vehicle.yaml")), HasSubstr("unknown option \"tll\""));
  const std::string kept = std::getenv("LCM_DEFAULT_URL");
  setenv("LCM_DEFAULT_URL", "nonsense", 1);
  EXPECT_THAT(words_of(""), HasSubstr("must begin with a provider"));
  setenv("LCM_DEFAULT_URL", kept.c_str(), 1);
}

}  // namespace
}  // namespace v2vouch
