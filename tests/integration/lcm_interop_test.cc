// SPDX-License-Identifier: Apache-2.0
// LcmBus beside liblcm itself, over UDP in a private network: sizes, both ways; an interface that
// goes and comes back; who is heard.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>

#include <atomic>
#include <cstdlib>
#include <map>
#include <thread>

#include "daemon/rim/io/lcm_bus.h"
#include "tests/integration/program.h"
#include "tests/support/lcm_datagrams.h"

namespace v2vouch {
namespace {

using namespace std::chrono_literals;
using testing::Eventually;
using testing::Octets;
using testing::Pattern;

std::string Url(const std::string& options = "") {
  return std::string(std::getenv("LCM_DEFAULT_URL")) + options;
}

bool Shell(const std::string& command) { return std::system(command.c_str()) == 0; }

class LcmInterop : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
  }
};

// liblcm, with its own threads and defaults.
class Liblcm {
 public:
  Liblcm() : lcm_(lcm_create(Url().c_str())) { EXPECT_NE(lcm_, nullptr); }
  ~Liblcm() { lcm_destroy(lcm_); }
  void Publish(const std::string& channel, const Octets& bytes) {
    EXPECT_EQ(lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())),
              0);
  }
  void Listen(const std::string& channel) {
    lcm_subscribe(
        lcm_, channel.c_str(),
        [](const lcm_recv_buf_t* buffer, const char*, void* user) {
          const auto* const data = static_cast<const std::uint8_t*>(buffer->data);
          static_cast<Liblcm*>(user)->heard_.emplace_back(data, data + buffer->data_size);
        },
        this);
  }
  bool Hears(const Octets& bytes) {
    return Eventually(
        [&] {
          lcm_handle_timeout(lcm_, 20);
          return !heard_.empty() && heard_.back() == bytes;
        },
        2s);
  }

 private:
  lcm_t* lcm_;
  std::vector<Octets> heard_;
};

// Our bus, drained by a thread of its own as in the daemon.
class Ours {
 public:
  explicit Ours(const std::string& url) : bus_(LcmBus::Open(url)) {
    EXPECT_TRUE(bus_);
    EXPECT_TRUE(bus_->Subscribe(
        "DATA", [this](std::span<const std::uint8_t> bytes, std::size_t size, Timestamp received) {
          EXPECT_EQ(bytes.size(), size);
          EXPECT_GT(ToMicros(received), 1'600'000'000'000'000);
          {
            const std::lock_guard lock(mutex_);
            newest_.assign(bytes.begin(), bytes.end());
          }
          ++count_;
        }));
    thread_ = std::thread([this] {
      while (!is_over_) bus_->Handle(20);
    });
  }
  ~Ours() {
    is_over_ = true;
    thread_.join();
  }
  [[nodiscard]] int count() const { return count_; }
  bool Has(const Octets& bytes) {
    const std::lock_guard lock(mutex_);
    return newest_ == bytes;
  }
  LcmBus& bus() { return *bus_; }

 private:
  std::unique_ptr<LcmBus> bus_;
  std::mutex mutex_;
  Octets newest_;
  std::atomic<int> count_ = 0;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

// At and round every border: one datagram or two, 8 MB in 129 fragments.
std::vector<std::size_t> Sizes() {
  return {1,      2,      100,     1400,    9000,      65'450,    65'480,    65'494,   65'495,
          65'496, 65'500, 130'000, 130'974, 1'000'000, 2'097'152, 4'000'000, 8'000'000};
}

TEST_F(LcmInterop, WhatLiblcmPublishesIsReceivedFromOneByteToEightMegabytes) {
  for (const std::string options : {"", "&receiver=liblcm"}) {
    Ours ours(Url(options));
    Liblcm liblcm;
    for (const std::size_t size : Sizes()) {
      const Octets data = Pattern(size, static_cast<std::uint32_t>(size));
      // The socket's buffer holds half of the largest: on a busy machine one may be lost.
      bool is_here = false;
      for (int attempt = 0; attempt < 20 && !is_here; ++attempt) {
        liblcm.Publish("OTHER", data);
        liblcm.Publish("DATA", data);
        is_here = Eventually([&] { return ours.Has(data); }, 500ms);
      }
      EXPECT_TRUE(is_here) << size << options;
    }
  }
}

TEST_F(LcmInterop, WhatWePublishIsReceivedByLiblcm) {
  const auto bus = LcmBus::Open(Url("&receiver=own"));
  ASSERT_TRUE(bus);
  Liblcm liblcm;
  liblcm.Listen("DATA");
  for (const std::size_t size : Sizes()) {
    const Octets data = Pattern(size, static_cast<std::uint32_t>(size));
    bool is_here = false;
    // 1.3.1 drains into a buffer of its own while it handles; the largest need luck.
    for (int attempt = 0; attempt < 20 && !is_here; ++attempt) {
      bus->Publish("DATA", data);
      is_here = liblcm.Hears(data);
    }
    EXPECT_TRUE(is_here) << size;
  }
}

TEST_F(LcmInterop, SeveralHandlersAndBusesAllHear) {
  Ours first(Url());
  Ours second(Url());
  int more = 0;
  const auto third = LcmBus::Open(Url());
  third->Subscribe("DATA", [&](auto, std::size_t, Timestamp) { ++more; });
  third->Subscribe("DATA", [&](auto, std::size_t, Timestamp) { ++more; });
  third->Publish("DATA", Octets{1});
  third->Publish("D", Octets{1});
  third->Publish("DATA2", Octets{1});
  EXPECT_TRUE(Eventually([&] { return first.count() == 1 && second.count() == 1; }, 2s));
  EXPECT_TRUE(Eventually([&] { return third->Handle(10) && more == 2; }, 2s));
}

TEST_F(LcmInterop, OnlyThoseNamedInTheUrlAreHeard) {
  Ours here(Url("&from=127.0.0.0/8"));
  Ours elsewhere(Url("&from=10.1.2.3,192.168.0.0/16"));
  Liblcm liblcm;
  liblcm.Publish("DATA", {1});
  EXPECT_TRUE(Eventually([&] { return here.count() == 1; }, 2s));
  EXPECT_TRUE(Eventually(
      [&] {
        return elsewhere.bus()
                   .refused()[static_cast<std::size_t>(lcm_packets::PacketFault::kSource)] == 1;
      },
      2s));
  EXPECT_EQ(elsewhere.count(), 0);
}

// A publisher needs no receiving socket, and has none to be attacked through.
TEST_F(LcmInterop, ABusWithoutSubscriptionsReceivesNothing) {
  const auto bus = LcmBus::Open(Url());
  EXPECT_TRUE(bus->Publish("DATA", Octets{1}));
  EXPECT_TRUE(bus->Handle(1));
  EXPECT_FALSE(Shell("grep -qi ':1DF3 00000000:0000' /proc/self/net/udp"));
}

// Each of these costs liblcm, or a socket that only listens, its membership for ever.
TEST_F(LcmInterop, AnInterfaceThatGoesAndComesBackIsHeardAgain) {
  if (std::string(std::getenv("V2VOUCH_PRIVATE_LCM")) != "namespace") {
    GTEST_SKIP()
        << "SKIPPED: no network namespace of our own, so interfaces are not ours to change";
  }
  const std::string route = "ip route add 224.0.0.0/4 dev lo";
  Ours ours(Url());
  const auto is_heard = [&] {
    const int before = ours.count();
    return Eventually(
        [&] {
          Liblcm().Publish("DATA", {1});
          return ours.count() > before;
        },
        5s);
  };
  ASSERT_TRUE(is_heard());
  ASSERT_TRUE(Shell("ip link set lo down && ip link set lo up && " + route));
  EXPECT_TRUE(is_heard());
  ASSERT_TRUE(
      Shell("ip addr flush dev lo && ip link set lo down && ip addr add 127.0.0.1/8 dev lo && "
            "ip link set lo multicast on up && " +
            route));
  EXPECT_TRUE(is_heard());
  // To another interface and back, which is made new in between.
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE(
        Shell("ip link add vehicle0 type veth peer name vehicle1 && "
              "ip addr add 10.9.8.7/24 dev vehicle0 && ip link set vehicle0 up && "
              "ip link set vehicle1 up && ip route replace 224.0.0.0/4 dev vehicle0"));
    EXPECT_TRUE(is_heard()) << round;
    ASSERT_TRUE(Shell("ip link del vehicle0 && " + route));
    EXPECT_TRUE(is_heard()) << round;
  }
  EXPECT_GE(ours.bus().rejoins(), 4);
}

}  // namespace
}  // namespace v2vouch
