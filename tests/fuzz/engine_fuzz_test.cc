// SPDX-License-Identifier: Apache-2.0
// A good drive with damaged, extreme, lost, repeated and reordered messages, through decoder, core
// and encoder: nothing crashes, nothing that is published is not finite or not decodable.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

using testing::WireMessage;

std::vector<WireMessage> Drive() {
  testing::SyntheticDrive drive;
  drive.duration_s = 3.0;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  drive.cars.push_back({.x_m = 60.0, .y_m = 3.5, .yaw_rad = 3.14, .speed_mps = 8.0, .sender = 7});
  drive.cars.push_back({.x_m = 20.0, .y_m = -3.5, .speed_mps = 7.0, .sender = 9, .is_real = false});
  return testing::EncodeInputs(testing::MakeInputs(drive), VehicleConfig{});
}

void PutDouble(std::vector<std::uint8_t>& bytes, std::size_t at, double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof(bits));
  for (std::size_t i = 0; i < 8 && at + i < bytes.size(); ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(bits >> (56 - 8 * i));
  }
}

// One change behind the fingerprint: a bit, an extreme double where one may lie, or an extreme
// word.
void Damage(std::vector<std::uint8_t>& bytes, std::mt19937_64& rng) {
  constexpr std::array<double, 12> kExtremes = {0.0,  -0.0, 1e-300, -1e-12, 1e-3,  1.0,
                                                -1.0, 3.2,  99.0,   119.0,  999.0, -1e9};
  const std::size_t at = 8 + rng() % (bytes.size() - 8);
  switch (rng() % 3) {
    case 0:
      bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << (rng() % 8)));
      break;
    case 1:
      PutDouble(bytes, 8 + 8 * (rng() % (bytes.size() / 8)), kExtremes[rng() % kExtremes.size()]);
      break;
    default:
      for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i) {
        bytes[i] = static_cast<std::uint8_t>(rng());
      }
  }
}

void CheckPublished(const Outbox& outbox) {
  for (const Outbox::Message& message : outbox.messages()) {
    if (!message.channel.starts_with("TRACKS_")) continue;
    const auto list = wire::Decode<track_list_t>(message.bytes);
    ASSERT_TRUE(list) << message.channel;
    ASSERT_TRUE(std::isfinite(list->ego_x_odom_m + list->ego_y_odom_m + list->ego_yaw_odom_rad));
    for (const track_t& track : list->tracks) {
      double sum = track.x_body_m + track.y_body_m + track.yaw_body_rad + track.speed_mps +
                   track.yaw_rate_radps + track.accel_mps2 + track.length_m + track.width_m +
                   track.existence;
      for (int i = 0; i < 36; ++i) sum += track.covariance_odom[i] + track.covariance_body[i];
      ASSERT_TRUE(std::isfinite(sum)) << message.channel << " track " << track.id;
      for (int i = 0; i < 6; ++i) ASSERT_GE(track.covariance_odom[7 * i], 0.0) << message.channel;
    }
  }
}

class EngineFuzz : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(EngineFuzz, DamagedDriveNeitherCrashesNorPublishesNonsense) {
  std::mt19937_64 rng(GetParam());
  std::vector<WireMessage> messages = Drive();
  const std::uint64_t one_in = 2 + rng() % 30;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (rng() % one_in == 0) Damage(messages[i].bytes, rng);
    // Out of order by up to some messages; now and then far too late.
    if (rng() % 10 == 0) std::swap(messages[i], messages[rng() % 50 == 0 ? 0 : i - i % 7]);
  }
  Engine engine(DaemonConfig{});
  Outbox outbox;
  for (const WireMessage& message : messages) {
    outbox.Clear();
    const std::uint64_t times = rng() % 20 == 0 ? rng() % 3 : 1;
    for (std::uint64_t n = 0; n < times; ++n) {
      engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    }
    if (rng() % 100 == 0) engine.PublishStale(std::chrono::milliseconds(rng() % 3000), outbox);
    ASSERT_NO_FATAL_FAILURE(CheckPublished(outbox));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, EngineFuzz, ::testing::Range<std::uint64_t>(1, 31));

}  // namespace
}  // namespace v2vouch
