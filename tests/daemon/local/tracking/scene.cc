// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/local/tracking/scene.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/outline.h"

namespace v2vouch {
namespace {

Eigen::Matrix2d Rotation(double yaw) {
  Eigen::Matrix2d R;
  R << std::cos(yaw), -std::sin(yaw), std::sin(yaw), std::cos(yaw);
  return R;
}

// First point of the box that a ray meets, in axes of the car; false: the ray passes by.
bool Meet(const Eigen::Vector2d& from, const Eigen::Vector2d& ray, double half_length,
          double half_width, Eigen::Vector2d& point) {
  double near = 0.0, far = 1e9;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = axis == 0 ? half_length : half_width;
    const double a = (-half - from[axis]) / ray[axis];
    const double b = (half - from[axis]) / ray[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  point = from + near * ray;
  return near < far;
}

}  // namespace

VehicleConfig OneRadarOneCamera() {
  VehicleConfig vehicle;
  RadarConfig radar;
  radar.x_m = 3.7;
  radar.half_fov_rad = FromDegrees(60.0);
  radar.max_range_m = 120.0;
  radar.azimuth_sigma_rad = FromDegrees(0.5);
  vehicle.radars = {radar};
  return vehicle;
}

Scene::Scene(std::uint64_t seed) : vehicle(OneRadarOneCamera()), random_(seed) {
  for (int i = 0; i < 200; ++i) {
    poles_.emplace_back(random_.Uniform(-50.0, 400.0),
                        (i % 2 == 0 ? 1.0 : -1.0) * random_.Uniform(9.0, 30.0));
  }
}

void Scene::Advance(double dt_s) {
  time_us_ += std::llround(dt_s * 1e6);
  const auto move = [dt_s](Car& car) {
    constexpr int kSteps = 10;
    const double h = dt_s / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      car.p_W += h * car.speed_mps * Eigen::Vector2d(std::cos(car.yaw_rad), std::sin(car.yaw_rad));
      car.yaw_rad += h * car.yaw_rate_radps;
      car.speed_mps += h * car.accel_mps2;
    }
  };
  for (Car& car : cars) move(car);
  move(ego);
}

EgoState Scene::ego_state() const {
  EgoState state;
  state.stamp = now();
  state.X_OB = {ego.p_W.x(), ego.p_W.y(), ego.yaw_rad};
  state.speed_mps = ego.speed_mps;
  state.yaw_rate_radps = ego.yaw_rate_radps;
  state.speed_sigma_mps = 0.02;
  state.yaw_rate_sigma_radps = 0.001;
  return state;
}

std::vector<RadarMeasurement> Scene::Scan(int index) {
  const RadarConfig& radar = vehicle.radars[static_cast<std::size_t>(index)];
  const Eigen::Matrix2d R_WB = Rotation(ego.yaw_rad);
  const Eigen::Vector2d origin = ego.p_W + R_WB * Eigen::Vector2d(radar.x_m, radar.y_m);
  const double axis = ego.yaw_rad + radar.yaw_rad;
  const Eigen::Vector2d v_antenna =
      R_WB * Eigen::Vector2d(ego.speed_mps - ego.yaw_rate_radps * radar.y_m,
                             ego.yaw_rate_radps * radar.x_m);
  std::vector<RadarMeasurement> scan;
  const auto emit = [&](const std::vector<Eigen::Vector2d>& points, const Car& car) {
    RadarMeasurement z;
    z.radar = index;
    z.returns = static_cast<int>(points.size());
    const double n = z.returns;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
    std::vector<OutlineReturn> outline;
    for (const Eigen::Vector2d& p : points) {
      const Eigen::Vector2d line = p - origin;
      const Eigen::Vector2d r = p - car.p_W;
      const Eigen::Vector2d v =
          car.speed_mps * Eigen::Vector2d(std::cos(car.yaw_rad), std::sin(car.yaw_rad)) +
          car.yaw_rate_radps * Eigen::Vector2d(-r.y(), r.x());
      const Eigen::Vector3d one(
          line.norm() + random_.Normal(0.0, radar.range_sigma_m),
          WrapAngle(std::atan2(line.y(), line.x()) - axis) +
              random_.Normal(0.0, radar.azimuth_sigma_rad),
          line.normalized().dot(v - v_antenna) + random_.Normal(0.0, radar.range_rate_sigma_mps));
      outline.push_back({one[0], one[1], 0.0});
      sum += one;
      squares += one.cwiseAbs2();
      low = low.cwiseMin(one);
      high = high.cwiseMax(one);
    }
    const Eigen::Vector3d mean = sum / n;
    Eigen::Vector3d variance(radar.range_sigma_m * radar.range_sigma_m,
                             radar.azimuth_sigma_rad * radar.azimuth_sigma_rad,
                             radar.range_rate_sigma_mps * radar.range_rate_sigma_mps);
    if (n > 1.0) {
      variance = variance.cwiseMax((squares - n * mean.cwiseAbs2()) / (n - 1.0));
    }
    z.range_m = mean[0];
    z.azimuth_rad = mean[1];
    z.range_rate_mps = mean[2];
    z.covariance = (variance / n).asDiagonal();
    const double bearing = z.azimuth_rad + axis;
    z.ground_range_rate_mps =
        z.range_rate_mps + v_antenna.dot(Eigen::Vector2d(std::cos(bearing), std::sin(bearing)));
    z.is_static = std::abs(z.ground_range_rate_mps) < 0.6;
    z.near_range_m = low[0];
    z.radial_extent_m = high[0] - low[0];
    z.azimuth_min_rad = low[1];
    z.azimuth_max_rad = high[1];
    z.middle_azimuth_rad = mean[1];
    if (extended) {
      z.outline_count = std::min(KeepOutline(outline), RadarMeasurement::kMostOutline);
      std::copy_n(outline.begin(), z.outline_count, z.outline.begin());
    }
    scan.push_back(z);
  };
  const auto in_view = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d line = p - origin;
    return line.norm() < radar.max_range_m && line.norm() > radar.min_range_m &&
           std::abs(WrapAngle(std::atan2(line.y(), line.x()) - axis)) < radar.half_fov_rad;
  };
  for (const Car& car : cars) {
    if (car.is_hidden || car.is_absent || !in_view(car.p_W)) continue;
    if (!random_.Bernoulli(detection_probability)) continue;
    if (!extended) {
      emit({car.p_W}, car);
      continue;
    }
    const Eigen::Matrix2d R_WT = Rotation(car.yaw_rad);
    const Eigen::Vector2d from = R_WT.transpose() * (origin - car.p_W);
    const double around = std::atan2(-from.y(), -from.x());
    const double half = std::asin(std::min(0.99, 0.5 * car.length_m / from.norm() + 0.02));
    for (int part = 0; part < split; ++part) {
      std::vector<Eigen::Vector2d> points;
      // Each part is seen under its own share of the angle, as clustering would cut it.
      const int wanted = 1 + random_.Poisson(2.0);
      const double from_angle = around - half + 2.0 * half * part / split;
      for (int ray = 0; ray < 40 && static_cast<int>(points.size()) < wanted; ++ray) {
        const double angle = from_angle + random_.Uniform(0.0, 2.0 * half / split);
        Eigen::Vector2d point;
        const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
        if (!Meet(from, direction, 0.5 * car.length_m, 0.5 * car.width_m, point)) continue;
        points.push_back(car.p_W + R_WT * point);
      }
      if (points.empty()) continue;
      emit(points, car);
    }
  }
  const int false_clusters = clutter > 0.0 ? random_.Poisson(clutter) : 0;
  for (int i = 0; i < false_clusters; ++i) {
    Car ghost;
    const double bearing = axis + random_.Uniform(-radar.half_fov_rad, radar.half_fov_rad);
    ghost.p_W = origin + random_.Uniform(3.0, radar.max_range_m) *
                             Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    ghost.yaw_rad = bearing;
    ghost.speed_mps = random_.Uniform(-20.0, 20.0);
    emit({ghost.p_W}, ghost);
  }
  int shown = 0;
  for (const Eigen::Vector2d& pole : poles_) {
    if (shown == standing) break;
    if (!in_view(pole)) continue;
    emit({pole}, Car{.p_W = pole});
    ++shown;
  }
  return scan;
}

// Whether nearer cars cover more than half of what the camera would see of a car.
bool Scene::IsCovered(const Car& car) const {
  const auto span = [this](const Car& other) {
    const Eigen::Vector2d line = other.p_W - ego.p_W;
    const double across = std::abs(std::sin(other.yaw_rad - std::atan2(line.y(), line.x())));
    const double width = other.length_m * across + other.width_m * (1.0 - across);
    return std::pair(WrapAngle(std::atan2(line.y(), line.x()) - ego.yaw_rad),
                     0.5 * width / line.norm());
  };
  const auto [bearing, half] = span(car);
  double covered = 0.0;
  for (const Car& other : cars) {
    if (&other == &car || (other.p_W - ego.p_W).norm() >= (car.p_W - ego.p_W).norm()) continue;
    const auto [at, reach] = span(other);
    covered +=
        std::max(0.0, std::min(bearing + half, at + reach) - std::max(bearing - half, at - reach));
  }
  return covered > half;
}

std::vector<CameraMeasurement> Scene::Picture(int index) {
  const CameraConfig& camera = vehicle.cameras[static_cast<std::size_t>(index)];
  const Eigen::Matrix2d R_WB = Rotation(ego.yaw_rad);
  const Eigen::Vector2d origin = ego.p_W + R_WB * Eigen::Vector2d(camera.x_m, camera.y_m);
  const Eigen::Matrix2d R_CW = Rotation(-(ego.yaw_rad + camera.yaw_rad));
  const double half_fov = std::atan2(0.5 * camera.image_width_px, camera.fx_px);
  const double pitch = random_.Normal(0.0, camera.pitch_sigma_rad);
  const double edge = camera.edge_sigma_px / camera.fx_px;
  std::vector<CameraMeasurement> picture;
  for (const Car& car : cars) {
    if (car.is_hidden || car.is_absent || IsCovered(car) ||
        !random_.Bernoulli(camera.detection_probability)) {
      continue;
    }
    double left = -10.0, right = 10.0, depth = 1e9;
    bool is_ahead = true;
    for (const double a : {1.0, -1.0}) {
      for (const double b : {1.0, -1.0}) {
        const double scale = extended ? 0.5 : 1e-4;
        const Eigen::Vector2d corner =
            R_CW * (car.p_W +
                    Rotation(car.yaw_rad) *
                        Eigen::Vector2d(a * scale * car.length_m, b * scale * car.width_m) -
                    origin);
        is_ahead = is_ahead && corner.x() > 0.5;
        const double bearing = std::atan2(corner.y(), corner.x());
        left = std::max(left, bearing);
        right = std::min(right, bearing);
        depth = std::min(depth, corner.x());
      }
    }
    if (!is_ahead || right > half_fov || left < -half_fov || depth > camera.max_range_m) continue;
    CameraMeasurement z;
    z.camera = index;
    z.left_is_cut = left > half_fov;
    z.right_is_cut = right < -half_fov;
    z.azimuth_left_rad = std::min(left + random_.Normal(0.0, edge), half_fov);
    z.azimuth_right_rad = std::max(right + random_.Normal(0.0, edge), -half_fov);
    const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
    z.depression_rad =
        std::atan2(camera.z_m * std::cos(middle), depth) + pitch + random_.Normal(0.0, edge);
    z.azimuth_sigma_rad = edge;
    z.depression_sigma_rad = std::hypot(edge, camera.pitch_sigma_rad);
    z.object_class = car.object_class;
    z.score = 0.8;
    picture.push_back(z);
  }
  return picture;
}

Detectability Scene::Answer(const LocalTrack& track, double nominal, double half_fov_rad,
                            const Eigen::Vector2d& sensor_B) const {
  const Eigen::Vector2d p = track.state_O.mean.head<2>();
  for (const Car& car : cars) {
    if (car.is_hidden && (car.p_W - p).norm() < 12.0) return {0.02, Visibility::kHidden};
  }
  const Eigen::Vector2d origin = ego.p_W + Rotation(ego.yaw_rad) * sensor_B;
  const Eigen::Vector2d line = p - origin;
  if (std::abs(WrapAngle(std::atan2(line.y(), line.x()) - ego.yaw_rad)) > half_fov_rad) {
    return {0.0, Visibility::kOutOfView};
  }
  return {nominal, Visibility::kVisible};
}

void Scene::Radar(Tracker& tracker, int radar) { Radar(tracker, Scan(radar), radar); }

void Scene::Radar(Tracker& tracker, const std::vector<RadarMeasurement>& scan, int radar) {
  tracker.Predict(now());
  const RadarConfig& device = vehicle.radars[static_cast<std::size_t>(radar)];
  const double half_fov = device.half_fov_rad;
  tracker.UpdateRadar(radar, ego_state(), scan, [&](const LocalTrack& track) {
    return Answer(track, detection_probability, half_fov, {device.x_m, device.y_m});
  });
}

void Scene::Camera(Tracker& tracker, int camera) { Camera(tracker, Picture(camera), camera); }

void Scene::Camera(Tracker& tracker, const std::vector<CameraMeasurement>& picture, int index) {
  tracker.Predict(now());
  const CameraConfig& camera = vehicle.cameras[static_cast<std::size_t>(index)];
  const double half_fov = std::atan2(0.5 * camera.image_width_px, camera.fx_px);
  tracker.UpdateCamera(index, ego_state(), picture, [&](const LocalTrack& track) {
    for (const Car& car : cars) {
      const double distance = (car.p_W - track.state_O.mean.head<2>()).norm();
      if (distance < 3.0 && IsCovered(car)) return Detectability{0.02, Visibility::kVisible};
    }
    return Answer(track, camera.detection_probability, half_fov, {camera.x_m, camera.y_m});
  });
}

const LocalTrack* Scene::Find(const Tracker& tracker, const Car& car, double reach_m) {
  const LocalTrack* nearest = nullptr;
  for (const LocalTrack& track : tracker.tracks()) {
    if (!track.is_confirmed) continue;
    const double distance = (track.state_O.mean.head<2>() - car.p_W).norm();
    if (distance < reach_m) {
      reach_m = distance;
      nearest = &track;
    }
  }
  return nearest;
}

int Scene::Confirmed(const Tracker& tracker) {
  int count = 0;
  for (const LocalTrack& track : tracker.tracks()) count += track.is_confirmed ? 1 : 0;
  return count;
}

}  // namespace v2vouch
