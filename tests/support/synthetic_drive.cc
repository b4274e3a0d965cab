// SPDX-License-Identifier: Apache-2.0
#include "tests/support/synthetic_drive.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"
#include "daemon/common/geodesy/ecef.h"

namespace v2vouch::testing {
namespace {

constexpr double kRadarPeriod_s = 0.05;
constexpr double kCameraPeriod_s = 0.1;
constexpr double kEgoPeriod_s = 0.02;
constexpr double kSlowPeriod_s = 0.1;  // GNSS and BSM.
constexpr double kClaimAge_s = 0.1;

const Wgs84 kOrigin{FromDegrees(48.0), FromDegrees(11.0), 500.0};

struct Place {
  double x_m, y_m;
};

Place At(const SyntheticCar& car, double t) {
  return {car.x_m + car.speed_mps * std::cos(car.yaw_rad) * t,
          car.y_m + car.speed_mps * std::sin(car.yaw_rad) * t};
}

// The near side of each car as three reflections across its width, as seen along the ray.
RadarScan MakeScan(const SyntheticDrive& drive, int radar, double t, std::int64_t seq,
                   Random& random) {
  const RadarConfig& mount = drive.vehicle.radars[static_cast<std::size_t>(radar)];
  RadarScan scan;
  scan.stamp = DriveStart() + FromSeconds(t);
  scan.received = scan.stamp;
  scan.seq = seq;
  scan.radar = radar;
  const double ego_x = drive.ego_speed_mps * t;
  for (const SyntheticCar& car : drive.cars) {
    if (!car.is_real) continue;
    const Place centre = At(car, t);
    for (int k = -1; k <= 1; ++k) {
      const double toward = std::atan2(mount.y_m - centre.y_m, ego_x + mount.x_m - centre.x_m);
      const double x =
          centre.x_m - ego_x - mount.x_m + 1.5 * std::cos(toward) - 0.6 * k * std::sin(toward);
      const double y = centre.y_m - mount.y_m + 1.5 * std::sin(toward) + 0.6 * k * std::cos(toward);
      const double range = std::hypot(x, y);
      const double azimuth = WrapAngle(std::atan2(y, x) - mount.yaw_rad);
      if (range > mount.max_range_m || std::abs(azimuth) > mount.half_fov_rad) continue;
      const double vx = car.speed_mps * std::cos(car.yaw_rad) - drive.ego_speed_mps;
      const double vy = car.speed_mps * std::sin(car.yaw_rad);
      RadarDetection detection;
      detection.range_m = range + mount.range_sigma_m * random.Normal();
      detection.azimuth_rad = azimuth + mount.azimuth_sigma_rad * random.Normal();
      detection.range_rate_mps =
          (x * vx + y * vy) / range + mount.range_rate_sigma_mps * random.Normal();
      detection.snr_db = 20.0;
      detection.rcs_dbsm = 10.0;
      scan.detections.push_back(detection);
    }
  }
  return scan;
}

CameraDetections MakeBoxes(const SyntheticDrive& drive, double t, std::int64_t seq,
                           Random& random) {
  const CameraConfig& mount = drive.vehicle.cameras[0];
  CameraDetections boxes;
  boxes.stamp = DriveStart() + FromSeconds(t);
  boxes.received = boxes.stamp;
  boxes.seq = seq;
  boxes.image_width_px = mount.image_width_px;
  boxes.image_height_px = mount.image_height_px;
  for (const SyntheticCar& car : drive.cars) {
    if (!car.is_real) continue;
    const Place centre = At(car, t);
    const double x = centre.x_m - drive.ego_speed_mps * t - mount.x_m;
    const double y = centre.y_m - mount.y_m;
    if (x < 4.0 || x > mount.max_range_m) continue;
    const double near = x - 2.2;  // Rear or front face of a car along the road.
    const double noise = mount.edge_sigma_px;
    const double left = mount.cx_px - mount.fx_px * (y + 0.9) / near + noise * random.Normal();
    const double right = mount.cx_px - mount.fx_px * (y - 0.9) / near + noise * random.Normal();
    const double bottom = mount.cy_px + mount.fy_px * mount.z_m / near + noise * random.Normal();
    if (left < 5.0 || right > mount.image_width_px - 5.0) continue;
    const double top = bottom - mount.fy_px * 1.5 / near;
    boxes.boxes.push_back({.left_px = left,
                           .top_px = top,
                           .width_px = right - left,
                           .height_px = bottom - top,
                           .object_class = ObjectClass::kCar,
                           .score = 0.9});
  }
  return boxes;
}

}  // namespace

Timestamp DriveStart() { return FromMicros(1'700'000'000'000'000); }

Bsm SpokenAt(const SyntheticCar& car, double t, int count, Random& random) {
  const LocalPlane plane(kOrigin);
  const Place centre = At(car, t - kClaimAge_s);
  const Wgs84 position = plane.ToGeodetic(
      {Eigen::Vector3d(centre.x_m + 0.3 * random.Normal(),
                       centre.y_m + car.claim_offset_m + 0.3 * random.Normal(), 0.0)});
  Bsm bsm;
  bsm.stamp = DriveStart() + FromSeconds(t);
  bsm.received = bsm.stamp;
  bsm.seq = static_cast<std::int64_t>(car.sender) * 100000 + count;
  bsm.sender = car.sender;
  bsm.generation = bsm.stamp - FromSeconds(kClaimAge_s);
  bsm.msg_count = count % 128;
  bsm.sec_mark_ms = static_cast<int>((ToMicros(*bsm.generation) / 1000) % 60000);
  bsm.latitude_rad = position.latitude_rad;
  bsm.longitude_rad = position.longitude_rad;
  bsm.semi_major_m = 1.0;
  bsm.semi_minor_m = 1.0;
  bsm.transmission = Transmission::kForward;
  bsm.speed_mps = std::abs(car.speed_mps + 0.05 * random.Normal());
  bsm.course_rad = WrapAngle(car.yaw_rad + 0.005 * random.Normal());
  bsm.accel_long_mps2 = 0.0;
  bsm.yaw_rate_radps = 0.0;
  bsm.length_m = 4.5;
  bsm.width_m = 1.8;
  return bsm;
}

std::vector<Input> MakeInputs(const SyntheticDrive& drive) {
  std::vector<Input> inputs;
  const LocalPlane plane(kOrigin);
  const auto steps = [&](double period) { return static_cast<int>(drive.duration_s / period); };

  for (int i = 0; i <= steps(kEgoPeriod_s); ++i) {
    EgoMotion ego;
    ego.stamp = DriveStart() + FromSeconds(kEgoPeriod_s * i);
    ego.received = ego.stamp;
    ego.seq = i;
    ego.speed_mps = drive.ego_speed_mps;
    ego.accel_long_mps2 = 0.0;
    ego.gear = Gear::kForward;
    inputs.emplace_back(ego);
  }
  for (int radar = 0; radar < static_cast<int>(drive.vehicle.radars.size()); ++radar) {
    Random random = Random::ForSubject(drive.seed, static_cast<std::uint64_t>(radar));
    for (int i = 0; i < steps(kRadarPeriod_s); ++i) {
      const double t = kRadarPeriod_s * i + 0.003 * (radar + 1);
      inputs.emplace_back(MakeScan(drive, radar, t, i, random));
    }
  }
  if (!drive.vehicle.cameras.empty()) {
    Random random = Random::ForSubject(drive.seed, 100);
    for (int i = 0; i < steps(kCameraPeriod_s); ++i) {
      inputs.emplace_back(MakeBoxes(drive, kCameraPeriod_s * i + 0.017, i, random));
    }
  }
  Random gnss_random = Random::ForSubject(drive.seed, 200);
  for (int i = 0; i < steps(kSlowPeriod_s); ++i) {
    const double t = kSlowPeriod_s * i + 0.041;
    const double jump =
        drive.gnss_jump_at_s >= 0.0 && t >= drive.gnss_jump_at_s ? drive.gnss_jump_m : 0.0;
    GnssFix fix;
    fix.stamp = DriveStart() + FromSeconds(t);
    fix.received = fix.stamp;
    fix.seq = i;
    fix.position = plane.ToGeodetic({Eigen::Vector3d(
        drive.ego_speed_mps * t + drive.vehicle.antenna_x_m + 0.1 * gnss_random.Normal(),
        drive.vehicle.antenna_y_m + jump + 0.1 * gnss_random.Normal(), 0.0)});
    fix.covariance_enu = Eigen::Matrix3d::Identity();
    fix.yaw_rad = 0.002 * gnss_random.Normal();
    fix.yaw_sigma_rad = 0.005;
    fix.velocity_en_mps = Eigen::Vector2d(drive.ego_speed_mps + 0.05 * gnss_random.Normal(),
                                          0.05 * gnss_random.Normal());
    fix.velocity_sigma_mps = 0.05;
    fix.fix_type = FixType::k3d;
    inputs.emplace_back(fix);
  }
  for (const SyntheticCar& car : drive.cars) {
    if (car.sender == 0) continue;
    Random random = Random::ForSubject(drive.seed, 1000 + car.sender);
    for (int i = 2; i < steps(kSlowPeriod_s); ++i) {
      const double t = kSlowPeriod_s * i + 0.001 * static_cast<double>(car.sender % 97);
      inputs.emplace_back(SpokenAt(car, t, i, random));
    }
  }
  std::stable_sort(inputs.begin(), inputs.end(), [](const Input& a, const Input& b) {
    return HeaderOf(a).stamp < HeaderOf(b).stamp;
  });
  return inputs;
}

}  // namespace v2vouch::testing
