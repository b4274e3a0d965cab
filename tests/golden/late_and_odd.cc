// SPDX-License-Identifier: Apache-2.0
#include "tests/golden/late_and_odd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "daemon/rim/wire/codec.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kHour_us = 3'600'000'000;

struct During {
  double t_s;
  [[nodiscard]] bool operator()(double from_s, double to_s) const {
    return t_s >= from_s && t_s < to_s;
  }
};

// Decodes, edits, encodes again.
template <class Message, class Edit>
void Edited(sim::SimEvent& event, const Edit& edit) {
  auto message = wire::Decode<Message>(event.bytes);
  if (!message) return;
  edit(*message);
  wire::Encode(*message, event.bytes);
}

void EditCamera(const During& is, sim::SimEvent& event) {
  Edited<camera_detections_t>(event, [&](camera_detections_t& picture) {
    if (is(3.0, 6.0)) picture.seq = 7;
    if (is(8.0, 10.0)) {
      for (camera_box_t& box : picture.boxes) box.class_name = "spaceship";
    }
    if (is(15.0, 99.0)) picture.utime += kHour_us;
  });
  if (is(4.0, 8.0)) event.arrival += FromSeconds(0.25);
}

void EditRadar(const During& is, sim::SimEvent& event) {
  Edited<radar_scan_t>(event, [&](radar_scan_t& scan) {
    if (event.channel == "RADAR_FRONT_LEFT" && is(6.0, 9.0)) scan.utime += 400'000;
    if (is(10.0, 11.0)) {
      for (radar_detection_t& detection : scan.detections) detection.snr_db = kNan;
    }
    if (is(15.0, 99.0)) scan.utime += kHour_us;
  });
}

void EditMotion(const During& is, sim::SimEvent& event) {
  Edited<ego_motion_t>(event, [&](ego_motion_t& motion) {
    if (is(5.0, 7.0)) motion.speed_sigma_mps = motion.yaw_rate_sigma_radps = 0.0;
    if (is(7.0, 8.0)) motion.accel_long_mps2 = kNan;
    if (is(15.0, 99.0)) motion.utime += kHour_us;
  });
}

void EditFix(const During& is, sim::SimEvent& event) {
  Edited<gnss_fix_t>(event, [&](gnss_fix_t& fix) {
    if (is(2.0, 99.0)) fix.altitude_m = kNan;
    if (is(15.0, 99.0)) fix.utime += kHour_us;
  });
}

void EditBsm(const During& is, sim::SimEvent& event) {
  Edited<bsm_t>(event, [&](bsm_t& message) {
    if (!is(15.0, 99.0)) return;
    message.rx_utime += kHour_us;
    if (message.generation_utime != 0) message.generation_utime += kHour_us;
  });
}

}  // namespace

std::vector<sim::SimEvent> LateAndOdd(const std::vector<sim::SimEvent>& drive) {
  std::vector<sim::SimEvent> edited;
  int count = 0;
  for (sim::SimEvent event : drive) {
    const During is{ToSeconds(event.arrival - drive.front().arrival)};
    if (event.channel.starts_with("CAMERA_")) {
      EditCamera(is, event);
    } else if (event.channel.starts_with("RADAR_")) {
      EditRadar(is, event);
    } else if (event.channel == "EGO_MOTION") {
      if (is(12.0, 12.6)) continue;
      EditMotion(is, event);
    } else if (event.channel == "EGO_GNSS") {
      EditFix(is, event);
    } else if (event.channel == "BSM") {
      EditBsm(is, event);
    }
    edited.push_back(event);
    if (++count % 7 == 0) edited.push_back(std::move(event));
  }
  std::stable_sort(edited.begin(), edited.end(),
                   [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  return edited;
}

}  // namespace v2vouch::testing
