// SPDX-License-Identifier: Apache-2.0
// v2vouch-obu between a unit's UDP and LCM, in a network of its own.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>

#include "daemon/obu/j2735/message_frame.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/program.h"
#include "tests/support/obu_wrap.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/obu_status_t.hpp"

namespace v2vouch::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kPort = 5398;

class Unit {
 public:
  explicit Unit(const char* own_address) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    inet_pton(AF_INET, own_address, &own.sin_addr);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    to_.sin_family = AF_INET;
    to_.sin_port = htons(kPort);
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Unit() { close(socket_); }
  void Send(const Octets& bytes) const {
    sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
           sizeof to_);
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

Octets Message(int number) {
  obu::Bsm bsm;
  bsm.core.id = static_cast<std::uint32_t>(number % 50 + 1);
  bsm.core.msg_count = number % 128;
  bsm.core.lat = 480000000 + number;
  bsm.core.lon = 110000000;
  bsm.core.speed = 700;
  Octets frame(64);
  std::size_t size = 0;
  EXPECT_FALSE(obu::WriteBsmFrame(bsm, frame, size));
  frame.resize(size);
  switch (number % 4) {
    case 0:
      return frame;
    case 1:
      return WrapWsmp(WrapSigned(frame));
    case 2:
      return WrapC2p(WrapWlan(WrapLlc(WrapWsmp(WrapSigned(frame)))), 0x11, -70);
    default:
      return WrapUnsecured(frame);
  }
}

class LiveObu : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_BIN") == nullptr) GTEST_SKIP() << "SKIPPED: V2VOUCH_BIN is not set";
    bus_ = LcmBus::Open("");
    ASSERT_TRUE(bus_);
    ASSERT_TRUE(bus_->Subscribe("BSM", [this](auto bytes, std::size_t, Timestamp) {
      const auto message = wire::Decode<bsm_t>(bytes);
      ASSERT_TRUE(message);
      lats_[message->lat] += 1;
      last_ = *message;
    }));
    ASSERT_TRUE(bus_->Subscribe("OBU_STATUS", [this](auto bytes, std::size_t, Timestamp) {
      const auto message = wire::Decode<obu_status_t>(bytes);
      ASSERT_TRUE(message);
      status_ = *message;
      ++statuses_;
    }));
    program_.emplace(
        std::vector<std::string>{std::string(std::getenv("V2VOUCH_BIN")) + "/v2vouch-obu", "--port",
                                 std::to_string(kPort)},
        ::testing::TempDir() + "live_obu.txt");
    ASSERT_TRUE(Eventually(
        [this] { return program_->Output().find("event=listening") != std::string::npos; }, 10s));
  }

  // Takes what arrives until `condition` holds.
  bool Until(const std::function<bool()>& condition, std::chrono::milliseconds timeout) {
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      bus_->Handle(20);
    }
    return true;
  }
  static std::int64_t CountOf(const std::vector<count_t>& counts, const std::string& name) {
    for (const count_t& each : counts) {
      if (each.name == name) return each.count;
    }
    return 0;
  }

  std::unique_ptr<LcmBus> bus_;
  std::optional<Program> program_;
  std::map<int, int> lats_;
  bsm_t last_{};
  obu_status_t status_{};
  int statuses_ = 0;
};

TEST_F(LiveObu, EveryMessageComesThroughOnceBesideAFloodAndIsCounted) {
  const Unit unit("127.0.0.1"), stranger("127.0.0.2");
  std::mt19937_64 rng(1);
  constexpr int kMessages = 600;
  for (int i = 0; i < kMessages; ++i) {
    unit.Send(Message(i));
    if (i % 10 == 0) unit.Send(Message(i));  // The other antenna.
    for (int k = 0; k < 5; ++k) {
      Octets garbage(20 + rng() % 300);
      for (auto& byte : garbage) byte = static_cast<std::uint8_t>(rng());
      stranger.Send(garbage);
    }
    // In step with the program: on a busy machine the kernel would drop what waits too long.
    if (i % 10 == 9) {
      ASSERT_TRUE(Until([&] { return lats_.size() == static_cast<std::size_t>(i) + 1; }, 10s)) << i;
    }
  }
  for (const auto& [lat, times] : lats_) EXPECT_EQ(times, 1) << lat;
  EXPECT_GT(last_.rx_utime, 1700000000000000);
  const int before = statuses_;
  EXPECT_TRUE(Until([&] { return statuses_ > before && status_.datagrams >= kMessages * 6; }, 5s));
  EXPECT_EQ(status_.published, kMessages);
  EXPECT_EQ(status_.duplicates, kMessages / 10);
  EXPECT_EQ(status_.kernel_drops, 0);
  EXPECT_EQ(status_.publish_failures, 0);
  EXPECT_EQ(status_.senders, 50);
  EXPECT_EQ(CountOf(status_.framings, "c2p"), kMessages / 4);
  EXPECT_GE(CountOf(status_.refusals, "unknown_framing"), kMessages * 4);
  EXPECT_EQ(CountOf(status_.sources, "127.0.0.2"), kMessages * 5);
  program_->Signal(SIGTERM);
  EXPECT_EQ(program_->Wait(5s), 0) << program_->Output();
}

TEST_F(LiveObu, SilenceIsToldAndEnded) {
  EXPECT_TRUE(Until([&] { return status_.obu_silent == 1; }, 10s));
  EXPECT_EQ(status_.senders, 0);
  const Unit unit("127.0.0.1");
  unit.Send(FromHex("001203aabbcc"));
  EXPECT_TRUE(Until([&] { return status_.obu_silent == 0; }, 5s));
  EXPECT_THAT(program_->Output(), ::testing::HasSubstr("event=obu_silent"));
  program_->Signal(SIGINT);
  EXPECT_EQ(program_->Wait(5s), 0);
}

}  // namespace
}  // namespace v2vouch::testing
