// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "sim/world/radio_specs.h"

/// Sections of a scenario file about what the ego measures: radar, camera, its own GNSS, odometry,
/// and how far its sensors sit from where they should.
namespace v2vouch::sim {

enum class SensorMode {
  kRealistic,    ///< Extended targets, static returns, clutter, ghosts, box errors.
  kIdealPoints,  ///< One detection at each visible vehicle's centre; nothing else.
  kCustom,       ///< By section `family`, as it is written.
  // By a `family` and a sensor set-up drawn for each run; see draw_sensors.h.
  kBumper,
  kCorners,
  kSparse,
  kMerged,
  kInside,
  kFewFace,
  kObjects,
  kMultipath,
  kRain,
  kBoxes,
  kOneRadar,
  kNoCamera,
  kNarrowCamera,
  kRandom,
};

/// In the order of the enum.
inline constexpr std::initializer_list<std::pair<const char*, SensorMode>> kSensorModeNames = {
    {"realistic", SensorMode::kRealistic}, {"ideal_points", SensorMode::kIdealPoints},
    {"custom", SensorMode::kCustom},       {"bumper", SensorMode::kBumper},
    {"corners", SensorMode::kCorners},     {"sparse", SensorMode::kSparse},
    {"merged", SensorMode::kMerged},       {"inside", SensorMode::kInside},
    {"few_face", SensorMode::kFewFace},    {"objects", SensorMode::kObjects},
    {"multipath", SensorMode::kMultipath}, {"rain", SensorMode::kRain},
    {"boxes", SensorMode::kBoxes},         {"one_radar", SensorMode::kOneRadar},
    {"no_camera", SensorMode::kNoCamera},  {"narrow_camera", SensorMode::kNarrowCamera},
    {"random", SensorMode::kRandom},
};
/// Whether a family and a sensor set-up are drawn for each run.
constexpr bool IsDrawn(SensorMode mode) { return mode >= SensorMode::kBumper; }

struct SensorsSpec {
  SensorMode mode = SensorMode::kRealistic;
  double noise_scale = 1.0;       ///< Of every sigma of radars, cameras and sources of objects.
  double clutter_scale = 1.0;     ///< Of the sensors' own clutter rates.
  double ghost_scale = 1.0;       ///< Of mirror and double-bounce ghosts; 0 = none.
  double detection_scale = 1.0;   ///< Of every detection probability.
  bool static_returns = false;    ///< With ideal points: scenery answers the radar all the same.
  double outlier_share = 0.0;     ///< Of radar reflections, boxes and fixes: off by up to 30 sigma.
  double frame_loss = 0.0;        ///< Share of whole radar scans and pictures that never arrive.
  double radar_latency_s = 0.02;  ///< Shortest; stamp to arrival.
  double radar_latency_spread_s = 0.02;
  double camera_latency_s = 0.06;
  double camera_latency_spread_s = 0.06;
  double objects_latency_s = 0.06;
  double objects_latency_spread_s = 0.06;
  bool objects_tell_velocity = false;    ///< Sources of objects tell velocities, ...
  bool objects_tell_covariance = false;  ///< ... covariances, ...
  bool objects_tell_ids = false;         ///< ... ids of their own.

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("mode", mode, kSensorModeNames);
    a.Field("noise_scale", noise_scale, {.at_least = 0.0, .at_most = 20.0});
    a.Field("clutter_scale", clutter_scale, {.at_least = 0.0, .at_most = 100.0});
    a.Field("ghost_scale", ghost_scale, {.at_least = 0.0, .at_most = 10.0});
    a.Field("detection_scale", detection_scale, {.at_least = 0.0, .at_most = 1.0});
    a.Field("static_returns", static_returns);
    a.Field("outlier_share", outlier_share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("frame_loss", frame_loss, {.at_least = 0.0, .at_most = 1.0});
    a.Field("radar_latency_s", radar_latency_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("radar_latency_spread_s", radar_latency_spread_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("camera_latency_s", camera_latency_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("camera_latency_spread_s", camera_latency_spread_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("objects_latency_s", objects_latency_s, {.at_least = 0.0, .at_most = 1.0});
    a.Field("objects_latency_spread_s", objects_latency_spread_s,
            {.at_least = 0.0, .at_most = 1.0});
    a.Field("objects_tell_velocity", objects_tell_velocity);
    a.Field("objects_tell_covariance", objects_tell_covariance);
    a.Field("objects_tell_ids", objects_tell_ids);
  }
};

/// The ego's own receiver.
struct EgoGnssSpec {
  double rate_hz = 10.0;
  GnssErrorSpec error;
  double latency_s = 0.05;  ///< Stamp to arrival.
  double velocity_sigma_mps = 0.05;
  bool has_heading = true;  ///< Dual antenna or the receiver's own fusion.
  double heading_bias_rad = FromDegrees(0.1);
  double heading_sigma_rad = FromDegrees(0.2);
  double ramp_at_s = 0.0;    ///< From then on the fix is carried away evenly, ...
  double ramp_s = 0.0;       ///< ... for so long (0 = never), velocity and all, ...
  double ramp_east_m = 0.0;  ///< ... as far as this.
  double ramp_north_m = 0.0;
  double jump_at_s = 0.0;  ///< From then on the fix is off by jump_east/north; 0 = never.
  double jump_east_m = 0.0;
  double jump_north_m = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 0.5, .at_most = 50.0});
    a.Field("error", error);
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 2.0});
    a.Field("velocity_sigma_mps", velocity_sigma_mps, {.at_least = 0.0, .at_most = 10.0});
    a.Field("has_heading", has_heading);
    a.Degrees("heading_bias_deg", heading_bias_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Degrees("heading_sigma_deg", heading_sigma_rad, {.at_least = 0.0, .at_most = 180.0});
    a.Field("ramp_at_s", ramp_at_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("ramp_s", ramp_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("ramp_east_m", ramp_east_m, {.at_least = -1e6, .at_most = 1e6});
    a.Field("ramp_north_m", ramp_north_m, {.at_least = -1e6, .at_most = 1e6});
    a.Field("jump_at_s", jump_at_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("jump_east_m", jump_east_m, {.at_least = -1e6, .at_most = 1e6});
    a.Field("jump_north_m", jump_north_m, {.at_least = -1e6, .at_most = 1e6});
  }
};

/// The ego's wheel speed and gyro. Scale: a production car measured -0.8 % against its GNSS/INS.
struct OdometrySpec {
  double rate_hz = 50.0;
  double speed_scale = 1.004;  ///< Measured speed = this times the true one, plus noise.
  double speed_sigma_mps = 0.03;
  double y_m = 0.0;  ///< Speed is that of the body's point (0, y_m): v - y_m * yaw rate.
  double yaw_rate_bias_radps = FromDegrees(0.03);
  double yaw_rate_sigma_radps = FromDegrees(0.06);
  double accel_sigma_mps2 = 0.1;
  double latency_s = 0.003;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("rate_hz", rate_hz, {.at_least = 5.0, .at_most = 200.0});
    a.Field("speed_scale", speed_scale, {.at_least = 0.8, .at_most = 1.2});
    a.Field("speed_sigma_mps", speed_sigma_mps, {.at_least = 0.0, .at_most = 5.0});
    a.Field("y_m", y_m, {.at_least = -2.0, .at_most = 2.0});
    a.Degrees("yaw_rate_bias_degps", yaw_rate_bias_radps, {.at_least = -10.0, .at_most = 10.0});
    a.Degrees("yaw_rate_sigma_degps", yaw_rate_sigma_radps, {.at_least = 0.0, .at_most = 10.0});
    a.Field("accel_sigma_mps2", accel_sigma_mps2, {.at_least = 0.0, .at_most = 10.0});
    a.Field("latency_s", latency_s, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// How far one part of the ego car sits from where the `vehicle` section, and so the daemon's
/// configuration, has it: added to the nominal mounting.
struct MountingErrorSpec {
  std::string sensor;  ///< radar_<name>, camera_<name>, objects_<name> (lower case) or antenna.
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;  ///< This and the last two: cameras only.
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
  double roll_rad = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("sensor", sensor);
    a.Field("x_m", x_m, {.at_least = -2.0, .at_most = 2.0});
    a.Field("y_m", y_m, {.at_least = -2.0, .at_most = 2.0});
    a.Field("z_m", z_m, {.at_least = -1.0, .at_most = 1.0});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -20.0, .at_most = 20.0});
    a.Degrees("pitch_deg", pitch_rad, {.at_least = -20.0, .at_most = 20.0});
    a.Degrees("roll_deg", roll_rad, {.at_least = -20.0, .at_most = 20.0});
  }
};

}  // namespace v2vouch::sim
