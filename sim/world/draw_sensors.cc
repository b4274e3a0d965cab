// SPDX-License-Identifier: Apache-2.0
#include "sim/world/draw_sensors.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"

namespace v2vouch::sim {
namespace {

constexpr std::uint64_t kSubject = 0x5E45'0F5E'2D4A'17B1;  // Draws of its own.

class Drawer {
 public:
  Drawer(std::uint64_t seed, Scenario& scenario)
      : random_(Random::ForSubject(seed, kSubject)),
        scenario_(scenario),
        radar_(scenario.family.emplace().radar),
        camera_(scenario.family->camera) {}

  void Draw(SensorMode mode) {
    const bool is_random = mode == SensorMode::kRandom;
    SensorMode law = mode, setup = mode, boxes = mode;
    if (is_random) {
      constexpr SensorMode kLaws[] = {
          SensorMode::kBumper,  SensorMode::kCorners,   SensorMode::kSparse,
          SensorMode::kMerged,  SensorMode::kInside,    SensorMode::kFewFace,
          SensorMode::kObjects, SensorMode::kMultipath, SensorMode::kRain};
      law = kLaws[Index(std::size(kLaws))];
      constexpr SensorMode kSetups[] = {SensorMode::kBumper, SensorMode::kBumper,
                                        SensorMode::kOneRadar, SensorMode::kNoCamera,
                                        SensorMode::kNarrowCamera};
      setup = kSetups[Index(std::size(kSetups))];
      boxes = random_.Bernoulli(0.3) ? SensorMode::kBoxes : SensorMode::kBumper;
    }
    DrawRadars(setup, law == SensorMode::kObjects);
    DrawCameras(setup);
    DrawLaw(law);
    DrawBoxes(boxes, law == SensorMode::kRain);
    SensorsSpec& sensors = scenario_.sensors;
    sensors.camera_latency_s = U(0.05, 0.1);
    sensors.camera_latency_spread_s = U(0.02, 0.1);
    sensors.radar_latency_s = U(0.01, 0.04);
    sensors.radar_latency_spread_s = U(0.0, 0.03);
  }

 private:
  double U(double low, double high) { return random_.Uniform(low, high); }
  std::size_t Index(std::size_t size) {
    return std::min(size - 1,
                    static_cast<std::size_t>(random_.Uniform() * static_cast<double>(size)));
  }
  int Between(int low, int high) {
    return low + static_cast<int>(Index(static_cast<std::size_t>(high - low + 1)));
  }
  double Period(double least_hz, double most_hz) {
    // To the microsecond, as stamps are.
    return std::round(1e6 / U(least_hz, most_hz)) * 1e-6;
  }

  // One long-range radar ahead; corner radars at the front, or all round.
  void DrawRadars(SensorMode setup, bool gives_objects) {
    RadarConfig front;
    front.name = "FRONT";
    front.x_m = U(3.5, 3.8);
    front.y_m = U(-0.3, 0.3);
    front.half_fov_rad = FromDegrees(U(20.0, 45.0));
    front.min_range_m = U(0.5, 1.5);
    front.max_range_m = U(140.0, 200.0);
    front.range_sigma_m = U(0.1, 0.25);
    front.azimuth_sigma_rad = FromDegrees(U(0.2, 0.5));
    front.range_rate_sigma_mps = U(0.04, 0.12);
    front.period_s = Period(12.0, 25.0);
    front.clutter_per_scan = 0.5;
    if (gives_objects) front.output = RadarOutput::kObjects;
    RadarConfig corner = front;
    const double yaw = FromDegrees(U(42.0, 60.0));
    corner.half_fov_rad = FromDegrees(U(60.0, 75.0));
    corner.min_range_m = U(0.2, 0.6);
    corner.max_range_m = U(60.0, 90.0);
    corner.range_sigma_m = U(0.08, 0.2);
    corner.azimuth_sigma_rad = FromDegrees(U(0.5, 1.2));
    std::vector<RadarConfig> radars = {front};
    const auto add = [&](const char* name, double x, double y, double yaw_rad) {
      corner.name = name;
      corner.x_m = x;
      corner.y_m = y;
      corner.yaw_rad = yaw_rad;
      corner.period_s = Period(10.0, 20.0);  // Each runs by itself.
      radars.push_back(corner);
    };
    const double x = U(3.3, 3.6), y = U(0.7, 0.85), rear = U(-0.95, -0.7);
    const bool is_all_round = random_.Bernoulli(0.6);
    if (setup != SensorMode::kOneRadar) {
      add("FRONT_LEFT", x, y, yaw);
      add("FRONT_RIGHT", x, -y, -yaw);
      if (is_all_round) {
        add("REAR_LEFT", rear, y, kPi - yaw);
        add("REAR_RIGHT", rear, -y, yaw - kPi);
      }
    }
    scenario_.vehicle.radars = std::move(radars);
  }

  void DrawCameras(SensorMode setup) {
    CameraConfig camera;
    camera.name = "FRONT";
    camera.x_m = U(1.7, 2.1);
    camera.z_m = U(1.2, 1.5);
    camera.fx_px = setup == SensorMode::kNarrowCamera ? U(2200.0, 2800.0) : U(900.0, 1300.0);
    camera.fy_px = camera.fx_px;
    camera.period_s = Period(10.0, 25.0);
    camera.edge_sigma_px = 2.0;
    scenario_.vehicle.cameras = {camera};
    if (setup == SensorMode::kNoCamera) scenario_.vehicle.cameras.clear();
  }

  // The reflection law of an ordinary radar, which every family starts from.
  void DrawOrdinaryLaw() {
    RadarFamilySpec& r = radar_;
    r.specular_db = U(42.0, 50.0);
    r.specular_lobe_deg = U(8.0, 20.0);
    r.corner_db = U(32.0, 38.0);
    r.wheel_db = U(26.0, 33.0);
    r.face_points = Between(2, 3);
    r.face_db = U(26.0, 32.0);
    r.inside_points = Between(2, 4);
    r.inside_db = U(17.0, 24.0);
    r.inside_depth = U(0.6, 0.95);
    r.fading_s = U(0.5, 4.0);
    r.threshold_db = U(12.0, 15.0);
    r.cell_range_m = U(0.15, 0.35);
    r.cell_azimuth_deg = U(0.8, 2.0);
    r.most_returns = Between(5, 8);
    r.under_body = U(0.03, 0.12);
    r.double_bounce = U(0.0, 0.04);
    r.mirror = U(0.02, 0.08);
    r.ground_per_scan = U(0.3, 2.0);
    r.interference_share = U(0.0, 0.005);
  }

  void DrawLaw(SensorMode law) {
    DrawOrdinaryLaw();
    RadarFamilySpec& r = radar_;
    switch (law) {
      case SensorMode::kCorners:
        r.specular_db = U(24.0, 32.0);
        r.face_db = U(18.0, 26.0);
        r.corner_db = U(38.0, 44.0);
        r.wheel_db = U(36.0, 42.0);
        r.inside_db = U(16.0, 22.0);
        r.wheel_spin = U(0.2, 0.6);
        break;
      case SensorMode::kSparse:
        r.most_returns = Between(1, 2);
        r.inside_db += U(0.0, 8.0);
        r.cell_range_m = U(0.3, 0.8);
        break;
      case SensorMode::kMerged:
        r.cell_range_m = U(1.2, 2.5);
        r.cell_azimuth_deg = U(5.0, 9.0);
        r.cell_rate_mps = U(0.6, 1.5);
        break;
      case SensorMode::kInside:
        r.inside_db = U(32.0, 40.0);
        r.specular_db = U(32.0, 40.0);
        r.snr_given = false;
        break;
      case SensorMode::kFewFace:
        r.specular_db = U(14.0, 20.0);
        r.specular_lobe_deg = U(3.0, 6.0);
        r.corner_db = U(12.0, 18.0);
        r.face_db = U(10.0, 16.0);
        r.inside_db = U(26.0, 32.0);
        break;
      case SensorMode::kObjects:
        r.jump_every_s = U(0.5, 3.0);
        r.confirm_s = U(0.15, 0.5);
        r.coast_s = U(0.2, 1.0);
        r.new_id_every_s = U(4.0, 20.0);
        r.false_objects_per_s = U(0.02, 0.15);
        break;
      case SensorMode::kMultipath:
        r.under_body = U(0.25, 0.5);
        r.double_bounce = U(0.08, 0.2);
        r.mirror = U(0.15, 0.4);
        r.interference_share = U(0.005, 0.02);
        break;
      case SensorMode::kRain:
        r.rain_per_scan = U(3.0, 10.0);
        r.threshold_db += U(2.0, 5.0);  // Of the same returns: attenuation.
        r.ground_per_scan = U(1.0, 4.0);
        break;
      default:
        break;
    }
  }

  void DrawBoxes(SensorMode boxes, bool is_raining) {
    CameraFamilySpec& c = camera_;
    c.edge_white_px = U(0.7, 1.5);
    c.edge_markov_px = U(0.8, 2.0);
    c.edge_markov_share = U(0.005, 0.02);
    c.edge_tau_s = U(0.2, 1.0);
    c.amodal_share = U(0.0, 0.5);
    c.wrong_class_share = U(0.02, 0.1);
    c.misses_per_s = U(0.05, 0.2);
    c.miss_s = U(0.2, 0.6);
    c.false_per_s = U(0.02, 0.1);
    c.split_per_s = U(0.0, 0.05);
    c.pitch_rad = FromDegrees(U(0.1, 0.3));
    c.dive_rad = FromDegrees(U(0.1, 0.3));
    if (boxes == SensorMode::kBoxes) {
      c.edge_markov_px = U(2.0, 4.0);
      c.edge_markov_share = U(0.02, 0.05);
      c.amodal_share = U(0.4, 0.9);
      c.wrong_class_share = U(0.15, 0.35);
      c.class_spell_s = U(0.5, 3.0);
      c.false_per_s = U(0.15, 0.5);
      c.false_s = U(0.8, 3.0);
      c.split_per_s = U(0.1, 0.3);
      c.duplicate_share = U(0.01, 0.05);
      c.pitch_rad = FromDegrees(U(0.3, 0.6));
      c.dive_rad = FromDegrees(U(0.25, 0.5));
    }
    if (is_raining) {
      c.misses_per_s = U(0.3, 0.8);
      c.miss_s = U(0.4, 1.2);
    }
  }

  Random random_;
  Scenario& scenario_;
  RadarFamilySpec& radar_;
  CameraFamilySpec& camera_;
};

}  // namespace

std::vector<std::string> DrawnFamilies() {
  std::vector<std::string> names;
  for (const auto& [name, mode] : kSensorModeNames) {
    if (IsDrawn(mode)) names.emplace_back(name);
  }
  return names;
}

void DrawSensors(std::uint64_t seed, Scenario& scenario) {
  const SensorMode mode = scenario.sensors.mode;
  if (IsDrawn(mode)) Drawer(seed, scenario).Draw(mode);
  if (mode == SensorMode::kCustom && !scenario.family) scenario.family.emplace();
}

}  // namespace v2vouch::sim
