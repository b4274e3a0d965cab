// SPDX-License-Identifier: Apache-2.0
// This car's own BSMs: EGO_MOTION and EGO_GNSS over LCM in, UDP to the unit and OWN_BSM out.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/big_endian.h"
#include "daemon/obu/octets/byte_reader.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/program.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/obu_status_t.hpp"

namespace v2vouch::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kUnitPort = 1516;

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class LiveOwnBsm : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_BIN") == nullptr) GTEST_SKIP() << "SKIPPED: V2VOUCH_BIN is not set";
    bus_ = LcmBus::Open("");
    ASSERT_TRUE(bus_);
    ASSERT_TRUE(bus_->Subscribe("OWN_BSM", [this](auto bytes, std::size_t, Timestamp) {
      if (const auto message = wire::Decode<bsm_t>(bytes)) told_.push_back(*message);
    }));
    ASSERT_TRUE(bus_->Subscribe("OBU_STATUS", [this](auto bytes, std::size_t, Timestamp) {
      if (const auto message = wire::Decode<obu_status_t>(bytes)) status_ = *message;
    }));
    unit_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_port = htons(kUnitPort);
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(bind(unit_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
  }
  void TearDown() override {
    if (unit_ >= 0) close(unit_);
  }

  std::vector<std::string> Line(std::vector<std::string> more) const {
    std::vector<std::string> line = {std::string(std::getenv("V2VOUCH_BIN")) + "/v2vouch-obu",
                                     "--port", "5398", "--send-to", "127.0.0.1:1516"};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }

  // A car at 15 m/s, motion at 50 Hz and a fix at 5 Hz, as far as wanted.
  void Drive(std::chrono::milliseconds duration, bool has_fix, bool has_motion) {
    const auto end = std::chrono::steady_clock::now() + duration;
    for (int i = 0; std::chrono::steady_clock::now() < end; ++i) {
      if (has_motion) {
        ego_motion_t motion{};
        motion.utime = Now();
        motion.speed_mps = 15.0;
        motion.gear = ego_motion_t::GEAR_FORWARD;
        Publish("EGO_MOTION", motion);
      }
      if (has_fix && i % 10 == 0) {
        gnss_fix_t fix{};
        fix.utime = Now();
        fix.latitude_rad = FromDegrees(48.0);
        fix.longitude_rad = FromDegrees(11.0);
        fix.heading_rad = FromDegrees(90.0);
        fix.heading_sigma_rad = 0.01;
        fix.fix_type = gnss_fix_t::FIX_3D;
        Publish("EGO_GNSS", fix);
      }
      bus_->Handle(20);
      Take();
    }
  }

  template <class Message>
  void Publish(const std::string& channel, const Message& message) {
    wire::Encode(message, bytes_);
    bus_->Publish(channel, bytes_);
  }

  void Take() {
    std::vector<char> buffer(4096);
    for (;;) {
      const ssize_t size = recv(unit_, buffer.data(), buffer.size(), 0);
      if (size < 0) return;
      sent_.emplace_back(buffer.data(), static_cast<std::size_t>(size));
    }
  }

  std::unique_ptr<LcmBus> bus_;
  int unit_ = -1;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::string> sent_;
  std::vector<bsm_t> told_;
  obu_status_t status_{};
};

TEST_F(LiveOwnBsm, NothingIsSentWithoutTheWordThatTheUnitSendsNone) {
  Program program(Line({}), ::testing::TempDir() + "live_own_refused.txt");
  EXPECT_EQ(program.Wait(10s), 2);
  EXPECT_THAT(program.Output(), ::testing::HasSubstr("own_bsm.unit_sends_none"));
}

TEST_F(LiveOwnBsm, SpeaksWhileBothInputsAreFreshAndTellsTheDaemon) {
  Program program(Line({"--unit-sends-none"}), ::testing::TempDir() + "live_own.txt");
  ASSERT_TRUE(Eventually(
      [&] { return program.Output().find("event=own_bsm_armed") != std::string::npos; }, 10s));
  Drive(1500ms, false, true);
  EXPECT_TRUE(sent_.empty());
  Drive(3000ms, true, true);
  Take();
  EXPECT_GE(sent_.size(), 15u);  // 10 Hz, on a busy machine.
  EXPECT_LE(sent_.size(), 32u);
  ASSERT_FALSE(sent_.empty());
  EXPECT_TRUE(sent_[0].starts_with("Version=0.7\nType=BSM\nPSID=0x20\n")) << sent_[0];
  EXPECT_THAT(sent_[0], ::testing::HasSubstr("\nPayload=0014"));
  EXPECT_GE(told_.size() + 1, sent_.size());
  ASSERT_FALSE(told_.empty());
  EXPECT_EQ(told_.back().speed, 750);
  EXPECT_EQ(told_.back().heading, 7200);
  EXPECT_EQ(status_.own_state, obu_status_t::OWN_SENDING);
  EXPECT_EQ(BigEndian32(status_.own_id), BigEndian32(told_.back().id));

  Drive(3500ms, false, true);  // The last fix is good for 1.5 s.
  EXPECT_EQ(status_.own_state, obu_status_t::OWN_NO_FIX);
  const std::size_t before = sent_.size();
  Drive(1000ms, false, true);
  EXPECT_EQ(sent_.size(), before);
  EXPECT_THAT(program.Output(), ::testing::HasSubstr("event=own_bsm state=no_fix"));
  Drive(2500ms, true, true);
  EXPECT_GT(sent_.size(), before);
  EXPECT_EQ(status_.own_send_failures, 0);
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait(5s), 0) << program.Output();
}

}  // namespace
}  // namespace v2vouch::testing
