// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

#include "daemon/rim/wire/codec.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

using testing::WireMessage;

testing::SyntheticDrive Drive() {
  testing::SyntheticDrive drive;
  drive.duration_s = 4.0;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  drive.cars.push_back({.x_m = 45.0, .y_m = 3.5, .yaw_rad = 3.14, .speed_mps = 8.0});
  return drive;
}

const std::vector<WireMessage>& Messages() {
  static const std::vector<WireMessage> messages =
      testing::EncodeInputs(testing::MakeInputs(Drive()), VehicleConfig{});
  return messages;
}

struct Published {
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> published;
  std::string digest_local;
  std::string digest_priority;
  ReasonCounts refusals{};
  std::int64_t accepted = 0;
};

Published RunAll(const std::vector<WireMessage>& messages) {
  Engine engine(DaemonConfig{});
  Published run;
  Outbox outbox;
  const auto keep = [&] {
    for (const auto& message : outbox.messages()) {
      run.published[message.channel].push_back(message.bytes);
    }
    outbox.Clear();
  };
  engine.Start(outbox);
  keep();
  for (const WireMessage& message : messages) {
    engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    keep();
  }
  run.digest_local = engine.digest_local();
  run.digest_priority = engine.digest_priority();
  run.refusals = engine.refusals();
  run.accepted = engine.accepted();
  return run;
}

std::uint64_t CountOf(const Published& run, Reason reason) {
  return run.refusals[static_cast<std::size_t>(reason)];
}

// A predicted copy went out before the frames that were on their way: their lists stay in, and
// count in the digest all the same.
TEST(Engine, PublishedTimeNeverGoesBackBehindAStaleCopy) {
  Engine engine(DaemonConfig{});
  Outbox outbox;
  std::map<std::string, std::int64_t> newest;
  int withheld = 0;
  std::size_t count = 0;
  for (const WireMessage& message : Messages()) {
    outbox.Clear();
    engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    bool has_local = false;
    const auto check = [&] {
      for (const auto& each : outbox.messages()) {
        if (each.channel != "TRACKS_LOCAL" && each.channel != "TRACKS_PRIORITY") continue;
        has_local = has_local || each.channel == "TRACKS_LOCAL";
        const auto list = wire::Decode<track_list_t>(each.bytes);
        ASSERT_TRUE(list);
        EXPECT_GE(list->utime, newest[each.channel]);
        newest[each.channel] = list->utime;
      }
    };
    check();
    if (engine.has_lists() && !has_local) ++withheld;
    if (++count % 100 != 0) continue;
    outbox.Clear();
    engine.PublishStale(std::chrono::milliseconds(400), outbox);
    check();
  }
  EXPECT_GT(withheld, 10);
  EXPECT_EQ(engine.digest_local(), RunAll(Messages()).digest_local);
}

// One sensor's clock is a second ahead: its messages are refused, and the status names it.
TEST(Engine, AClockThatIsOffIsNamedInTheStatusWhileItIs) {
  std::vector<WireMessage> messages = Messages();
  std::vector<Input> inputs = testing::MakeInputs(Drive());
  for (Input& input : inputs) {
    auto* scan = std::get_if<RadarScan>(&input);
    if (scan != nullptr && scan->radar == 0) scan->stamp += std::chrono::seconds(1);
  }
  const auto wrong = testing::EncodeInputs(inputs, VehicleConfig{});
  for (std::size_t i = 0; i < messages.size(); ++i) messages[i].bytes = wrong[i].bytes;
  const Published run = RunAll(messages);
  const auto status = wire::Decode<daemon_status_t>(run.published.at("V2VOUCH_STATUS").back());
  ASSERT_TRUE(status);
  const auto notice = std::ranges::find_if(
      status->notices, [](const notice_t& each) { return each.name == "clock_ahead"; });
  ASSERT_NE(notice, status->notices.end());
  EXPECT_EQ(notice->channel, "RADAR_FRONT");
  EXPECT_NEAR(notice->value, 1.0, 0.1);
  for (const auto& input : status->inputs) EXPECT_EQ(input.is_silent, 0) << input.channel;
}

TEST(Engine, PublishesConfigurationAndCalibrationAtStart) {
  const Published run = RunAll({});
  ASSERT_EQ(run.published.at("V2VOUCH_CONFIG").size(), 1u);
  EXPECT_EQ(wire::Decode<text_t>(run.published.at("V2VOUCH_CONFIG")[0])->text,
            PrintDaemonConfig(DaemonConfig{}));
  EXPECT_EQ(run.published.at("CALIBRATION").size(), 1u);
}

TEST(Engine, GoodDriveGivesListsWithoutRefusalAndStatusOncePerSecond) {
  const Published run = RunAll(Messages());
  EXPECT_EQ(run.accepted, static_cast<std::int64_t>(Messages().size()));
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    EXPECT_EQ(run.refusals[i], 0u) << ReasonName(static_cast<Reason>(i));
  }
  const auto& statuses = run.published.at("V2VOUCH_STATUS");
  EXPECT_GE(statuses.size(), 4u);
  EXPECT_LE(statuses.size(), 5u);
  const auto status = wire::Decode<daemon_status_t>(statuses.back());
  ASSERT_TRUE(status);
  EXPECT_EQ(status->num_latencies, 0);
  EXPECT_EQ(status->local_tracks, 2);
  EXPECT_EQ(run.published.at("TRACKS_LOCAL").size(), run.published.at("TRACKS_PRIORITY").size());
  for (const auto& input : status->inputs) {
    if (!input.channel.starts_with("RADAR_")) continue;
    EXPECT_NEAR(input.rate_hz, 20.0, 2.0) << input.channel;
  }
}

TEST(Engine, SameMessagesGiveTheSameBytes) {
  const Published a = RunAll(Messages());
  const Published b = RunAll(Messages());
  EXPECT_EQ(a.published, b.published);
  EXPECT_EQ(a.digest_local, b.digest_local);
}

TEST(Engine, LocalIsTheSameBitForBitWithoutBsmsAndGnss) {
  std::vector<WireMessage> own;
  for (const WireMessage& message : Messages()) {
    if (message.channel != "BSM" && message.channel != "EGO_GNSS") own.push_back(message);
  }
  ASSERT_LT(own.size(), Messages().size());
  const Published with = RunAll(Messages());
  const Published without = RunAll(own);
  EXPECT_EQ(with.published.at("TRACKS_LOCAL"), without.published.at("TRACKS_LOCAL"));
  EXPECT_EQ(with.digest_local, without.digest_local);
}

// A gateway tells on OWN_BSM what it sends; every BSM under such an id is an echo.
TEST(Engine, WhatThisCarItselfSendsIsCountedAsAnEchoAndIsNoSender) {
  std::vector<WireMessage> messages;
  std::uint64_t bsms = 0;
  for (const WireMessage& message : Messages()) {
    if (message.channel == "BSM") {
      messages.push_back(message);
      messages.back().channel = "OWN_BSM";
      ++bsms;
    }
    messages.push_back(message);
  }
  ASSERT_GT(bsms, 0);
  const Published run = RunAll(messages);
  EXPECT_EQ(CountOf(run, Reason::kBsmOwnEcho), bsms);
  EXPECT_EQ(run.digest_local, RunAll(Messages()).digest_local);
  for (const char* channel : {"TRACKS_V2V", "TRACKS_PRIORITY"}) {
    for (const auto& bytes : run.published.at(channel)) {
      const auto list = wire::Decode<track_list_t>(bytes);
      ASSERT_TRUE(list);
      EXPECT_EQ(list->num_tracks, 0) << channel;
    }
  }
}

TEST(Engine, RefusedMessagesAreCountedByReasonAndChangeNothing) {
  std::vector<WireMessage> messages;
  for (const WireMessage& message : Messages()) {
    messages.push_back(message);
    if (messages.size() % 50 != 0) continue;
    WireMessage bad = message;
    bad.bytes.push_back(0);
    messages.push_back(bad);
    bad.bytes = {1, 2, 3};
    messages.push_back(bad);
    bad.channel = "NOBODY";
    messages.push_back(bad);
  }
  const Published good = RunAll(Messages());
  const Published mixed = RunAll(messages);
  const std::uint64_t rounds = (messages.size() - Messages().size()) / 3;
  EXPECT_EQ(CountOf(mixed, Reason::kTrailingBytes), rounds);
  EXPECT_EQ(CountOf(mixed, Reason::kTooShort), rounds);
  EXPECT_EQ(CountOf(mixed, Reason::kUnknownChannel), rounds);
  EXPECT_EQ(mixed.digest_local, good.digest_local);
  EXPECT_EQ(mixed.digest_priority, good.digest_priority);
}

TEST(Engine, SecondCopyOfEveryOwnMessageIsADuplicate) {
  std::vector<WireMessage> twice;
  std::uint64_t own = 0;
  for (const WireMessage& message : Messages()) {
    twice.push_back(message);
    if (message.channel == "BSM" || message.channel == "EGO_GNSS") continue;
    twice.push_back(message);
    ++own;
  }
  const Published once = RunAll(Messages());
  const Published doubled = RunAll(twice);
  EXPECT_EQ(CountOf(doubled, Reason::kDuplicate), own);
  EXPECT_EQ(doubled.digest_local, once.digest_local);
}

TEST(Engine, StaleListsAreMarkedAndInNoDigest) {
  Engine engine(DaemonConfig{});
  Outbox outbox;
  engine.PublishStale(std::chrono::milliseconds(100), outbox);
  EXPECT_TRUE(outbox.messages().empty());  // Nothing was ever seen.
  for (const WireMessage& message : Messages()) {
    engine.OnMessage(message.channel, message.bytes, message.received, outbox);
  }
  const std::string digest = engine.digest_local();
  outbox.Clear();
  engine.PublishStale(std::chrono::seconds(1), outbox);
  ASSERT_EQ(outbox.messages().size(), 2u);
  for (const auto& message : outbox.messages()) {
    const auto list = wire::Decode<track_list_t>(message.bytes);
    ASSERT_TRUE(list);
    EXPECT_EQ(list->stale, 1);
  }
  EXPECT_EQ(engine.digest_local(), digest);
}

TEST(Engine, CalibrationInForceIsToldByNameUnitAndVerdict) {
  DaemonConfig config;
  config.perception.vehicle.radars[1].yaw_rad = FromDegrees(55.4);
  const auto told = [](const DaemonConfig& by) {
    Engine engine(by);
    Outbox outbox;
    engine.Start(outbox);
    engine.PublishStatus(outbox);
    const auto status = wire::Decode<daemon_status_t>(outbox.messages()[2].bytes);
    const auto calibration = wire::Decode<calibration_t>(outbox.messages()[1].bytes);
    EXPECT_TRUE(status && calibration);
    return std::pair(*calibration, status->calibration);
  };
  const auto find = [](const calibration_t& calibration, const std::string& name) {
    for (const auto& parameter : calibration.parameters) {
      if (parameter.name == name) return parameter;
    }
    ADD_FAILURE() << name;
    return calibration_parameter_t{};
  };
  const auto [bare, bare_title] = told(config);
  EXPECT_EQ(bare.source, "configuration");
  EXPECT_EQ(bare_title, "configuration");
  EXPECT_EQ(bare.checksum, "");
  EXPECT_NEAR(find(bare, "radar_front_left.yaw_deg").value, 55.4, 1e-12);
  EXPECT_EQ(find(bare, "radar_front_left.yaw_deg").verdict, "PRIOR");
  EXPECT_TRUE(std::isnan(find(bare, "ego.speed_scale").std));

  config.calibration = "somewhere/mine.yaml";
  config.calibrated.emplace().checksum = std::string(64, 'b');
  config.calibrated->parameters = {
      {"radar_front_left.yaw_deg", 55.4, 0.02, 55.0, 1.0, CalibrationVerdict::kWeak, ""},
      {"ego.speed_scale", 3.0, 0.02, 1.0, 0.05, CalibrationVerdict::kRejected, ""}};
  const auto [filed, filed_title] = told(config);
  EXPECT_EQ(filed.source, "mine.yaml");
  EXPECT_EQ(filed_title, "mine.yaml bbbbbbbbbbbbbbbb");
  EXPECT_EQ(filed.checksum, std::string(64, 'b'));
  EXPECT_EQ(find(filed, "radar_front_left.yaw_deg").verdict, "WEAK");
  EXPECT_EQ(find(filed, "radar_front_left.yaw_deg").std, 0.02);
  // What is in force, with the doubt that is left of it.
  EXPECT_EQ(find(filed, "ego.speed_scale").verdict, "REJECTED");
  EXPECT_EQ(find(filed, "ego.speed_scale").value, 1.0);
  EXPECT_EQ(find(filed, "ego.speed_scale").std, 0.05);
}

// The one car that talks is validated within two seconds, and its residuals are settled 0.7 s
// later.
TEST(Engine, GpsBiasIsToldInTheStatusUnlessItIsSwitchedOff) {
  const auto last_status = [](bool is_enabled) {
    DaemonConfig config;
    config.gps_bias.enabled = is_enabled;
    Engine engine(config);
    Outbox outbox;
    for (const WireMessage& message : Messages()) {
      outbox.Clear();
      engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    }
    outbox.Clear();
    engine.PublishStatus(outbox);
    const auto status = wire::Decode<daemon_status_t>(outbox.messages()[0].bytes);
    EXPECT_TRUE(status);
    return *status;
  };
  const daemon_status_t on = last_status(true);
  EXPECT_GT(on.gps_bias.utime, on.utime - 3'000'000);
  EXPECT_TRUE(std::isnan(on.gps_bias.common_east_m));  // One sender says nothing of all.
  ASSERT_EQ(on.gps_bias.num_senders, 1);
  const sender_bias_t& sender = on.gps_bias.senders[0];
  EXPECT_EQ(sender.v2v_id[3], 0x11);
  EXPECT_EQ(sender.verdict, sender_bias_t::USED);
  EXPECT_EQ(on.gps_bias.num_used, 1);
  EXPECT_EQ(on.gps_bias.num_quarantined, 0);
  EXPECT_LT(std::hypot(sender.east_m, sender.north_m), 1.0);
  EXPECT_GT(sender.covariance_m2[0], 0.0);
  EXPECT_DOUBLE_EQ(sender.covariance_m2[1], sender.covariance_m2[2]);
  const daemon_status_t off = last_status(false);
  EXPECT_EQ(off.gps_bias.utime, 0);
  EXPECT_EQ(off.gps_bias.num_senders, 0);
  EXPECT_EQ(on.digest_local, off.digest_local);
}

// The world of the synthetic drive stands still but for its cars; a radar configured half a degree
// to the right of where it sits must be turned to the left.
TEST(Engine, ATurnedRadarIsToldInTheStatusAndNothingElseIsChanged) {
  const auto run = [](bool is_watched) {
    DaemonConfig config;
    config.mount_monitor.enabled = is_watched;
    config.mount_monitor.window_s = 10.0;
    config.perception.vehicle.radars[1].yaw_rad -= FromDegrees(0.5);
    testing::SyntheticDrive drive;
    drive.duration_s = 32.0;
    for (int i = 0; i < 60; ++i) {
      drive.cars.push_back({.x_m = 5.0 * i, .y_m = i % 2 == 0 ? 8.0 : -8.0});
    }
    Engine engine(config);
    Outbox outbox;
    for (const WireMessage& message :
         testing::EncodeInputs(testing::MakeInputs(drive), VehicleConfig{})) {
      outbox.Clear();
      engine.OnMessage(message.channel, message.bytes, message.received, outbox);
    }
    outbox.Clear();
    engine.PublishStatus(outbox);
    const auto status = wire::Decode<daemon_status_t>(outbox.messages()[0].bytes);
    EXPECT_TRUE(status);
    return *status;
  };
  const daemon_status_t watched = run(true);
  ASSERT_EQ(watched.num_mounts, 3);
  const mount_status_t& front = watched.mounts[0];
  const mount_status_t& left = watched.mounts[1];
  EXPECT_EQ(left.sensor, "radar_front_left");
  EXPECT_EQ(left.windows, 3);
  EXPECT_EQ(left.has_moved, 1);
  EXPECT_NEAR(ToDegrees(left.yaw_correction_rad), 0.5, 0.1);
  EXPECT_LT(left.yaw_sigma_rad, FromDegrees(0.1));
  EXPECT_EQ(front.has_moved, 0);
  EXPECT_NEAR(ToDegrees(front.yaw_correction_rad), 0.0, 0.1);
  const daemon_status_t unwatched = run(false);
  EXPECT_EQ(unwatched.mounts[1].windows, 0);
  EXPECT_EQ(unwatched.digest_local, watched.digest_local);
  EXPECT_EQ(unwatched.digest_priority, watched.digest_priority);
}

TEST(Engine, PicturesWithoutADetectorAreRefusedByName) {
  DaemonConfig config;
  config.perception.vehicle.cameras[0].source = CameraSource::kImage;
  Engine engine(config);
  camera_image_t image{};
  image.utime = 1'700'000'000'000'000;
  image.sensor = "FRONT";
  image.width_px = 1280;
  image.height_px = 720;
  image.encoding = "jpeg";
  image.data = {1, 2, 3};
  image.num_bytes = 3;
  std::vector<std::uint8_t> bytes;
  wire::Encode(image, bytes);
  Outbox outbox;
  engine.OnMessage("CAMERA_FRONT_IMAGE", bytes, {}, outbox);
  EXPECT_EQ(engine.refusals()[static_cast<std::size_t>(Reason::kNoDetector)], 1u);
}

}  // namespace
}  // namespace v2vouch
