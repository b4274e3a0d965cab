// SPDX-License-Identifier: Apache-2.0
#include "tests/scenario/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/common/base/angle.h"
#include "daemon/common/geodesy/ecef.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/engine.h"
#include "daemon/rim/wire/codec.h"
#include "sim/world/overlay.h"
#include "sim/world/scenario.h"
#include "sim/world/world.h"
#include "tests/support/simulated_events.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::testing {
namespace {

constexpr double kEarthRadius_m = 6371000.0;
constexpr double kClearOfTruth_m = 8.0;

bool IsFinite(const track_t& track) {
  const auto all = [](const double* values, std::size_t count) {
    return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
  };
  const double state[] = {track.x_body_m,  track.y_body_m,       track.yaw_body_rad,
                          track.x_odom_m,  track.y_odom_m,       track.yaw_odom_rad,
                          track.speed_mps, track.yaw_rate_radps, track.accel_mps2,
                          track.length_m,  track.width_m,        track.existence};
  return all(state, std::size(state)) && all(track.covariance_body, 36) &&
         all(track.covariance_odom, 36);
}

std::uint32_t IdOf(const track_t& track) {
  std::uint32_t id = 0;
  for (const std::uint8_t octet : track.v2v_id) id = id << 8 | octet;
  return id;
}

// A claim at (x, y) of the simulator's world, well formed and self-consistent.
bsm_t GhostMessage(const Ghost& ghost, const truth_list_t& truth, double x_m, double y_m,
                   int count) {
  const LocalPlane plane({truth.origin_latitude_rad, truth.origin_longitude_rad, 0.0});
  const Wgs84 place = plane.ToGeodetic({Eigen::Vector3d(x_m, y_m, 0.0)});
  constexpr double kLatLong = 1e7;
  bsm_t message{};
  message.rx_utime = truth.utime + 60'000;
  message.seq = count + static_cast<std::int64_t>(ghost.id) * 100'000;
  message.msgCnt = static_cast<std::int16_t>(count % 128);
  for (int i = 0; i < 4; ++i) {
    message.id[i] = static_cast<std::uint8_t>(ghost.id >> (24 - 8 * i));
  }
  message.secMark = static_cast<std::int32_t>(truth.utime / 1000 % 60'000);
  message.lat = static_cast<std::int32_t>(std::lround(ToDegrees(place.latitude_rad) * kLatLong));
  message.long_ = static_cast<std::int32_t>(std::lround(ToDegrees(place.longitude_rad) * kLatLong));
  message.elev = -4096;
  message.semiMajor = 10;
  message.semiMinor = 10;
  message.orientation = 0;
  message.transmission = 2;
  message.speed = static_cast<std::int16_t>(std::lround(std::abs(truth.ego_speed_mps) / 0.02));
  const double heading = WrapAngle(kPi / 2 - truth.ego_yaw_rad);
  message.heading = static_cast<std::int32_t>(std::lround(
                        ToDegrees(heading < 0.0 ? heading + 2 * kPi : heading) / 0.0125)) %
                    28800;
  message.angle = 127;
  message.accelSet_long = 0;
  message.accelSet_lat = 0;
  message.accelSet_vert = -127;
  message.accelSet_yaw = 0;
  message.width = 180;
  message.length = 450;
  message.rssi_dbm = -60.0F;
  return message;
}

// Squared distance to the nearest true vehicle [m^2].
double SquaredErrorOf(const track_t& track, const truth_list_t& truth) {
  const double c = std::cos(truth.ego_yaw_rad);
  const double s = std::sin(truth.ego_yaw_rad);
  double least = 1e12;
  for (const truth_object_t& object : truth.objects) {
    const double dx = object.x_m - truth.ego_x_m;
    const double dy = object.y_m - truth.ego_y_m;
    const double ex = track.x_body_m - (c * dx + s * dy);
    const double ey = track.y_body_m - (c * dy - s * dx);
    least = std::min(least, ex * ex + ey * ey);
  }
  return least;
}

}  // namespace

Recording Record(const std::string& name, std::uint64_t seed) {
  return RecordWith(name, seed, "", 0);
}

Recording RecordWith(const std::string& name, std::uint64_t seed, const std::string& overlay,
                     int vehicles) {
  sim::Scenario scenario;
  std::vector<std::string> problems;
  std::unique_ptr<sim::World> world;
  if (sim::LoadScenario("sim/scenarios/" + name + ".yaml", scenario, problems)) {
    if (!overlay.empty()) {
      sim::LayOver("sim/attacks/catalogue/" + overlay + ".yaml", scenario, problems);
    }
    if (vehicles > 0) scenario.traffic.vehicles = vehicles;
    world = sim::World::Make(scenario, seed, problems);
  }
  for (const std::string& problem : problems) ADD_FAILURE() << problem;
  return world ? AllEvents(*world, seed) : Recording{};
}

Outcome Perceive(const Recording& recording, const std::string& config_path) {
  DaemonConfig config;
  std::vector<std::string> problems;
  EXPECT_TRUE(LoadDaemonConfig(config_path, config, problems));
  Engine engine(config);
  Outbox outbox;
  Outcome outcome;
  std::optional<truth_list_t> truth;
  for (const sim::SimEvent& event : recording) {
    if (event.channel == "TRUTH") {
      if (const auto list = wire::Decode<truth_list_t>(event.bytes)) truth = *list;
    }
    outbox.Clear();
    engine.OnMessage(event.channel, event.bytes, event.arrival, outbox);
    for (const Outbox::Message& message : outbox.messages()) {
      if (message.channel == "MISBEHAVIOR") {
        const auto report = wire::Decode<misbehavior_report_t>(message.bytes);
        outcome.reports.push_back(report ? report->check : "does not decode");
        continue;
      }
      const bool is_priority = message.channel == "TRACKS_PRIORITY";
      if (!is_priority && message.channel != "TRACKS_LOCAL") continue;
      const auto list = wire::Decode<track_list_t>(message.bytes);
      if (!list) {
        ADD_FAILURE() << "our own list does not decode";
        continue;
      }
      (is_priority ? outcome.priority_tracks : outcome.local_tracks) += list->num_tracks;
      for (const track_t& track : list->tracks) {
        if (!IsFinite(track)) ++outcome.not_finite;
        if (!is_priority) continue;
        outcome.vouched.insert(IdOf(track));
        outcome.priority_ids[IdOf(track)].insert(track.id);
        if (!truth || track.local_id != 0) continue;
        outcome.hidden_error_m2 += SquaredErrorOf(track, *truth);
        ++outcome.hidden_entries;
      }
    }
  }
  outcome.digest_local = engine.digest_local();
  outcome.digest_priority = engine.digest_priority();
  outcome.refused = engine.refusals();
  return outcome;
}

Recording Without(const Recording& recording, const std::string& channel) {
  Recording rest;
  std::copy_if(recording.begin(), recording.end(), std::back_inserter(rest),
               [&](const sim::SimEvent& event) { return event.channel != channel; });
  return rest;
}

Recording WithGnssJump(const Recording& recording, double from_s, double north_m) {
  Recording edited = recording;
  const Timestamp from = recording.front().arrival + FromSeconds(from_s);
  for (sim::SimEvent& event : edited) {
    if (event.channel != "EGO_GNSS" || event.arrival < from) continue;
    auto fix = wire::Decode<gnss_fix_t>(event.bytes);
    if (!fix) continue;
    fix->latitude_rad += north_m / kEarthRadius_m;
    wire::Encode(*fix, event.bytes);
  }
  return edited;
}

Recording WithGhosts(const Recording& recording, const std::vector<Ghost>& ghosts) {
  Recording edited = recording;
  int count = 0;
  std::optional<std::int64_t> begin;
  for (const sim::SimEvent& event : recording) {
    if (event.channel != "TRUTH") continue;
    const auto truth = wire::Decode<truth_list_t>(event.bytes);
    if (!truth) continue;
    if (!begin) begin = truth->utime;
    if (++count % 2 != 0) continue;  // TRUTH comes at 20 Hz, BSMs at 10.
    const double t_s = static_cast<double>(truth->utime - *begin) * 1e-6;
    for (const Ghost& ghost : ghosts) {
      const auto [ahead, left] = ghost.where(t_s);
      const double c = std::cos(truth->ego_yaw_rad);
      const double s = std::sin(truth->ego_yaw_rad);
      const double x = truth->ego_x_m + c * ahead - s * left;
      const double y = truth->ego_y_m + s * ahead + c * left;
      const bool is_near_truth =
          std::any_of(truth->objects.begin(), truth->objects.end(), [&](const truth_object_t& o) {
            return std::hypot(o.x_m - x, o.y_m - y) < kClearOfTruth_m + 0.5 * o.length_m;
          });
      if (is_near_truth) continue;
      sim::SimEvent message{
          .arrival = FromMicros(truth->utime + 60'000), .channel = "BSM", .bytes = {}};
      wire::Encode(GhostMessage(ghost, *truth, x, y, count), message.bytes);
      edited.push_back(std::move(message));
    }
  }
  std::stable_sort(edited.begin(), edited.end(),
                   [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  return edited;
}

}  // namespace v2vouch::testing
