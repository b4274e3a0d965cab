// SPDX-License-Identifier: Apache-2.0
#include "sim/radio/relay.h"

#include <gtest/gtest.h>

#include "daemon/obu/framing/datagram.h"
#include "sim/radio/envelope.h"

namespace v2vouch::sim {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;
using Bytes = std::vector<std::uint8_t>;

truth_object_t Object(std::int64_t id, double x_m, double y_m, double height_m = 1.5) {
  truth_object_t object{};
  object.id = id;
  object.x_m = x_m;
  object.y_m = y_m;
  object.length_m = 8.0;
  object.width_m = 2.5;
  object.height_m = height_m;
  return object;
}

truth_list_t Truth(std::vector<truth_object_t> objects) {
  truth_list_t truth{};
  truth.objects = std::move(objects);
  truth.num_objects = static_cast<std::int32_t>(truth.objects.size());
  return truth;
}

RadioConfig ThreeCars() {
  RadioConfig config;
  config.cars = {{.id = 0, .deliver = "127.0.0.1:1"},
                 {.id = 1, .listen = 6001, .deliver = "127.0.0.1:2"},
                 {.id = 2, .listen = 6002}};
  return config;
}

TEST(Relay, EveryListeningCarButTheSenderHears) {
  Relay relay(ThreeCars(), 1);
  relay.OnTruth(Truth({Object(1, 10.0, 0.0), Object(2, 20.0, 0.0)}));
  relay.OnDatagram(1, Bytes{1}, kStart);
  relay.OnDatagram(2, Bytes{2}, kStart);
  std::multiset<std::pair<std::size_t, int>> heard;
  while (const auto delivery = relay.Next(kStart + 1000000)) {
    heard.insert({delivery->car, delivery->bytes[0]});
  }
  const std::multiset<std::pair<std::size_t, int>> wanted = {{0, 1}, {0, 2}, {1, 2}};
  EXPECT_EQ(heard, wanted);
  EXPECT_EQ(relay.figures().heard, 3);
}

TEST(Relay, NothingIsHandedOverBeforeItsTime) {
  RadioConfig config = ThreeCars();
  config.link.delay_s = 0.01;
  Relay relay(config, 1);
  relay.OnTruth(Truth({Object(1, 10.0, 0.0), Object(2, 20.0, 0.0)}));
  relay.OnDatagram(1, Bytes{1}, kStart);
  EXPECT_FALSE(relay.Next(kStart + 9999));
  ASSERT_TRUE(relay.due());
  EXPECT_TRUE(relay.Next(*relay.due()));
  EXPECT_FALSE(relay.due());
}

TEST(Relay, ACarThatIsNowhereIsNotHeard) {
  Relay relay(ThreeCars(), 1);
  relay.OnDatagram(1, Bytes{1}, kStart);
  relay.OnTruth(Truth({Object(2, 20.0, 0.0)}));
  relay.OnDatagram(1, Bytes{1}, kStart);
  EXPECT_FALSE(relay.due());
  EXPECT_EQ(relay.figures().nowhere, 2);
}

// Only what is as high as an antenna on a roof.
TEST(Relay, ATruckOrABuildingBetweenBlocksACarDoesNot) {
  RadioConfig config = ThreeCars();
  const auto blocked = [&](const truth_list_t& truth) {
    Relay relay(config, 1);
    relay.OnTruth(truth);
    relay.OnDatagram(2, Bytes{1}, kStart);
    return relay.figures().blocked;
  };
  EXPECT_EQ(blocked(Truth({Object(1, 30.0, 0.0, 1.5), Object(2, 60.0, 0.0)})), 0);
  EXPECT_EQ(
      blocked(Truth({Object(1, 500.0, 90.0), Object(2, 60.0, 0.0), Object(3, 30.0, 0.0, 3.5)})), 1);
  config.obstacles = {{.x_m = 30.0, .y_m = 0.0}};
  EXPECT_EQ(blocked(Truth({Object(1, 500.0, 90.0), Object(2, 60.0, 0.0)})), 1);
}

TEST(Relay, ACarMoreChangesNothingForTheOthers) {
  const auto heard_by_ego = [](bool has_third) {
    RadioConfig config = ThreeCars();
    config.link.open_90_m = 20.0;
    Relay relay(config, 5);
    relay.OnTruth(Truth({Object(1, 40.0, 0.0), Object(2, 35.0, 0.0)}));
    std::vector<std::int64_t> times;
    for (int i = 0; i < 300; ++i) {
      relay.OnDatagram(1, Bytes{1}, kStart + i * 100000LL);
      if (has_third) relay.OnDatagram(2, Bytes{2}, kStart + i * 100000LL + 50);
    }
    while (const auto delivery = relay.Next(kStart + 100000000)) {
      if (delivery->car == 0 && delivery->bytes[0] == 1) times.push_back(delivery->utime);
    }
    return times;
  };
  EXPECT_FALSE(heard_by_ego(false).empty());
  EXPECT_EQ(heard_by_ego(true), heard_by_ego(false));
}

TEST(RadioPacket, IsReadBackWithItsSignal) {
  for (const std::size_t size : {60u, 127u, 128u, 400u}) {
    Bytes payload = {0x00, 0x12};  // A MAP of this size: the envelope is what matters.
    if (size - 3 < 0x80) {
      payload.push_back(static_cast<std::uint8_t>(size - 3));
    } else {
      payload.push_back(static_cast<std::uint8_t>(0x80 | ((size - 4) >> 8)));
      payload.push_back(static_cast<std::uint8_t>((size - 4) & 0xFF));
    }
    payload.resize(size);
    Bytes scratch(obu::kLongestDatagram);
    obu::Datagram datagram;
    const Bytes packet = RadioPacket(payload, -83);
    obu::ReadDatagram(packet, {}, scratch, datagram);
    EXPECT_EQ(datagram.fault.kind, obu::FaultKind::kNotBsm) << size;
    EXPECT_EQ(datagram.rssi_dbm(), -83);
  }
}

}  // namespace
}  // namespace v2vouch::sim
