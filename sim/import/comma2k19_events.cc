// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/codec.h"
#include "sim/import/comma2k19.h"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::sim {
namespace {

constexpr double kNotAvailable = std::numeric_limits<double>::quiet_NaN();

// Frames of one radar cycle follow each other within 12 ms, cycles 50 ms apart.
constexpr double kScanGap_s = 0.025;

// CAN speed reads 0.8 % low against the post-processed pose: 0.14 m/s at town speed.
constexpr double kSpeedSigma_mps = 0.15;
// Noise of one gyro sample is 0.0028 rad/s, its bias on this drive 0.0008.
constexpr double kYawRateSigma_radps = 0.003;
// Receiver's position: bias 0.54 m and 0.09-0.22 m per axis on top; rounded up.
constexpr double kPositionSigma_m = 1.0;
constexpr double kHeightSigma_m = 2.0;
constexpr double kVelocitySigma_mps = 0.12;
// Course equals heading only while the car moves well.
constexpr double kCourseSpeed_mps = 3.0;
constexpr double kHeadingSigma_rad = FromDegrees(1.0);

// Seconds of boot time -> UTC.
class BootClock {
 public:
  BootClock(const Comma2k19Segment& segment, double latency_s) {
    std::vector<double> offsets;
    for (const auto& fix : segment.fixes) {
      offsets.push_back(static_cast<double>(fix.utc_ms) * 1e-3 - fix.t_s);
    }
    // The median: single fixes come out late by tens of milliseconds.
    const auto middle = offsets.begin() + static_cast<std::ptrdiff_t>(offsets.size() / 2);
    std::nth_element(offsets.begin(), middle, offsets.end());
    offset_ = FromSeconds(*middle + latency_s);
  }
  [[nodiscard]] Timestamp ToUtc(double boot_s) const {
    return Timestamp(offset_ + FromSeconds(boot_s));
  }

 private:
  Duration offset_{};
};

template <class Message>
ImportedEvent MakeEvent(Timestamp received, std::string channel, const Message& message) {
  ImportedEvent event{received, std::move(channel), {}};
  wire::Encode(message, event.bytes);
  return event;
}

radar_detection_t ToDetection(const Comma2k19Segment::RadarRow& row,
                              const Comma2k19Options& options) {
  const double x_m = row.long_m + options.range_offset_m;
  const double y_m = options.flip_lateral ? -row.lat_m : row.lat_m;
  radar_detection_t detection{};
  detection.range_m = std::hypot(x_m, y_m);
  detection.azimuth_rad = std::atan2(y_m, x_m);
  detection.range_rate_mps = row.rel_speed_mps;
  detection.rcs_dbsm = kNotAvailable;
  detection.snr_db = kNotAvailable;
  detection.track_id = row.slot;
  return detection;
}

void AddScans(const Comma2k19Segment& segment, const Comma2k19Options& options,
              const BootClock& clock, std::vector<ImportedEvent>& events) {
  std::int64_t seq = 0;
  for (auto first = segment.radar.begin(); first != segment.radar.end();) {
    auto last = first;
    auto end = std::next(first);
    while (end != segment.radar.end() && end->t_s - last->t_s < kScanGap_s) last = end++;
    radar_scan_t scan{};
    scan.utime = ToMicros(clock.ToUtc(first->t_s));
    scan.seq = seq++;
    scan.sensor = options.radar_name;
    for (auto row = first; row != end; ++row) {
      scan.detections.push_back(ToDetection(*row, options));
    }
    scan.num_detections = static_cast<std::int32_t>(scan.detections.size());
    events.push_back(MakeEvent(clock.ToUtc(last->t_s), "RADAR_" + options.radar_name, scan));
    first = end;
  }
}

void AddMotion(const Comma2k19Segment& segment, const BootClock& clock,
               std::vector<ImportedEvent>& events) {
  std::int64_t seq = 0;
  auto gyro = segment.gyro.begin();
  double yaw_rate_radps = -segment.gyro.front().down_radps;
  for (const auto& row : segment.speed) {
    // What came in since the last speed sample, averaged: no future, no sample twice.
    double sum = 0.0;
    int count = 0;
    for (; gyro != segment.gyro.end() && gyro->t_s <= row.t_s; ++gyro, ++count) {
      sum -= gyro->down_radps;  // Down axis: right turn positive. Ours: left.
    }
    if (count > 0) yaw_rate_radps = sum / count;
    ego_motion_t motion{};
    motion.utime = ToMicros(clock.ToUtc(row.t_s));
    motion.seq = seq++;
    motion.speed_mps = row.speed_mps;
    motion.speed_sigma_mps = kSpeedSigma_mps;
    motion.yaw_rate_radps = yaw_rate_radps;
    motion.yaw_rate_sigma_radps = kYawRateSigma_radps;
    // The device is tilted: gravity puts 0.7 m/s^2 into its forward axis. Better none than that.
    motion.accel_long_mps2 = kNotAvailable;
    motion.accel_long_sigma_mps2 = kNotAvailable;
    motion.accel_lat_mps2 = kNotAvailable;
    motion.accel_lat_sigma_mps2 = kNotAvailable;
    motion.gear = ego_motion_t::GEAR_UNKNOWN;
    events.push_back(MakeEvent(clock.ToUtc(row.t_s), "EGO_MOTION", motion));
  }
}

void AddFixes(const Comma2k19Segment& segment, const BootClock& clock,
              std::vector<ImportedEvent>& events) {
  std::int64_t seq = 0;
  for (const auto& row : segment.fixes) {
    const double bearing_rad = FromDegrees(row.bearing_deg);
    gnss_fix_t fix{};
    fix.utime = row.utc_ms * 1000;
    fix.seq = seq++;
    fix.latitude_rad = FromDegrees(row.latitude_deg);
    fix.longitude_rad = FromDegrees(row.longitude_deg);
    fix.altitude_m = row.altitude_m;
    fix.covariance_enu_m2[0] = fix.covariance_enu_m2[4] = kPositionSigma_m * kPositionSigma_m;
    fix.covariance_enu_m2[8] = kHeightSigma_m * kHeightSigma_m;
    const bool has_course = row.speed_mps > kCourseSpeed_mps;
    fix.heading_rad = has_course
                          ? std::fmod(bearing_rad + 2.0 * std::numbers::pi, 2.0 * std::numbers::pi)
                          : kNotAvailable;
    fix.heading_sigma_rad = has_course ? kHeadingSigma_rad : kNotAvailable;
    fix.velocity_east_mps = row.speed_mps * std::sin(bearing_rad);
    fix.velocity_north_mps = row.speed_mps * std::cos(bearing_rad);
    fix.velocity_up_mps = kNotAvailable;
    fix.velocity_sigma_mps = kVelocitySigma_mps;
    fix.fix_type = gnss_fix_t::FIX_3D;
    events.push_back(MakeEvent(clock.ToUtc(row.t_s), "EGO_GNSS", fix));
  }
}

}  // namespace

std::vector<ImportedEvent> ToEvents(const Comma2k19Segment& segment,
                                    const Comma2k19Options& options, std::string& error) {
  if (segment.radar.empty() || segment.speed.empty() || segment.gyro.empty() ||
      segment.fixes.empty()) {
    error = "radar, speed, gyro and GNSS are all needed, and one of them is empty";
    return {};
  }
  const BootClock clock(segment, options.gnss_latency_s);
  std::vector<ImportedEvent> events;
  AddMotion(segment, clock, events);  // First: at equal times the car's own motion leads.
  AddFixes(segment, clock, events);
  AddScans(segment, options, clock, events);
  std::stable_sort(
      events.begin(), events.end(),
      [](const ImportedEvent& a, const ImportedEvent& b) { return a.received < b.received; });
  return events;
}

}  // namespace v2vouch::sim
