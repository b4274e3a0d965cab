// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/sensor.h"

namespace v2vouch {

/// What kind of list a radar delivers.
enum class RadarOutput {
  kReflections,  ///< Several plain reflections per vehicle: thresholded and clustered by us.
  kObjects,      ///< The sensor tracks by itself: one detection with track_id per object.
};

/// One radar: where it sits, how it speaks, what it can see and how well.
struct RadarConfig {
  std::string name = "FRONT";  ///< Channel is RADAR_<NAME>.
  double x_m = 0.0;            ///< Antenna in B.
  double y_m = 0.0;
  double yaw_rad = 0.0;          ///< Of the antenna's axis, left positive.
  bool flip_azimuth = false;     ///< The sensor counts azimuth to the right.
  bool flip_range_rate = false;  ///< The sensor counts approaching as positive.
  double range_offset_m = 0.0;   ///< Added to every range.
  double clock_offset_s = 0.0;   ///< Added to every stamp.
  double period_s = 0.05;        ///< Nominal; silence is flagged after three.
  RadarOutput output = RadarOutput::kReflections;
  double half_fov_rad = FromDegrees(60.0);  ///< Covered azimuth is +- this.
  double min_range_m = 0.5;
  double max_range_m = 80.0;
  double range_sigma_m = 0.25;  ///< Of one reflection, 1 sigma, as the next two.
  double azimuth_sigma_rad = FromDegrees(1.0);
  double range_rate_sigma_mps = 0.1;
  double detection_probability = 0.95;  ///< Of a car in clear view at close range.
  double clutter_per_scan = 0.5;        ///< Expected false clusters in one scan.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("x_m", x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("y_m", y_m, {.at_least = -5.0, .at_most = 5.0});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Field("flip_azimuth", flip_azimuth);
    a.Field("flip_range_rate", flip_range_rate);
    a.Field("range_offset_m", range_offset_m, {.at_least = -20.0, .at_most = 20.0});
    a.Field("clock_offset_s", clock_offset_s, {.at_least = -1.0, .at_most = 1.0});
    a.Field("period_s", period_s, {.at_least = 0.01, .at_most = 1.0});
    a.Choice("output", output,
             {{"reflections", RadarOutput::kReflections}, {"objects", RadarOutput::kObjects}});
    a.Degrees("half_fov_deg", half_fov_rad, {.above = 0.0, .at_most = 180.0});
    a.Field("min_range_m", min_range_m, {.at_least = 0.0, .at_most = 20.0});
    a.Field("max_range_m", max_range_m, {.above = 1.0, .at_most = 500.0});
    a.Field("range_sigma_m", range_sigma_m, {.above = 0.0, .at_most = 10.0});
    a.Degrees("azimuth_sigma_deg", azimuth_sigma_rad, {.above = 0.0, .at_most = 20.0});
    a.Field("range_rate_sigma_mps", range_rate_sigma_mps, {.above = 0.0, .at_most = 10.0});
    a.Field("detection_probability", detection_probability, {.above = 0.0, .below = 1.0});
    a.Field("clutter_per_scan", clutter_per_scan, {.above = 0.0, .at_most = 100.0});
  }
};

/// Which of a camera's channels is consumed; exactly one is.
enum class CameraSource {
  kBoxes,     ///< CAMERA_<NAME>: boxes of a smart camera.
  kImage,     ///< CAMERA_<NAME>_IMAGE: pictures, through our detector.
  kDetected,  ///< CAMERA_<NAME>_DETECTED: what our detector saw when the log was recorded.
};

/// One camera. Pixels: pinhole with the OpenCV distortion model, axes x right, y down, z forward.
struct CameraConfig {
  std::string name = "FRONT";
  CameraSource source = CameraSource::kBoxes;
  double x_m = 1.8;  ///< Optical centre in B; z above the road.
  double y_m = 0.0;
  double z_m = 1.4;
  double yaw_rad = 0.0;    ///< Left positive.
  double pitch_rad = 0.0;  ///< Down positive.
  double roll_rad = 0.0;   ///< Right side down positive.
  int image_width_px = 1280;
  int image_height_px = 720;
  double fx_px = 1000.0;
  double fy_px = 1000.0;
  double cx_px = 640.0;
  double cy_px = 360.0;
  std::vector<double> distortion{};  ///< k1 k2 p1 p2 k3; empty = rectified.
  double clock_offset_s = 0.0;
  double period_s = 0.1;
  double max_range_m = 120.0;                 ///< Farther vehicles are too small for a box.
  double edge_sigma_px = 2.0;                 ///< Of each edge of a box, 1 sigma.
  double pitch_sigma_rad = FromDegrees(0.2);  ///< Body pitch and slope of the road, per picture.
  double detection_probability = 0.9;
  double clutter_per_image = 0.1;
  double min_score = 0.3;  ///< Weaker boxes are ignored.
  /// A box whose bottom edge a nearer box covers by more than this share tells no range: for
  /// detectors that draw what they see of a vehicle. 1: every bottom is believed.
  double covered_bottom_share = 1.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Choice("source", source,
             {{"boxes", CameraSource::kBoxes},
              {"image", CameraSource::kImage},
              {"detected", CameraSource::kDetected}});
    a.Field("x_m", x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("y_m", y_m, {.at_least = -5.0, .at_most = 5.0});
    a.Field("z_m", z_m, {.above = 0.0, .at_most = 10.0});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Degrees("pitch_deg", pitch_rad, {.at_least = -45.0, .at_most = 45.0});
    a.Degrees("roll_deg", roll_rad, {.at_least = -45.0, .at_most = 45.0});
    a.Field("image_width_px", image_width_px, {.at_least = 16, .at_most = 16384});
    a.Field("image_height_px", image_height_px, {.at_least = 16, .at_most = 16384});
    a.Field("fx_px", fx_px, {.above = 1.0, .at_most = 1e5});
    a.Field("fy_px", fy_px, {.above = 1.0, .at_most = 1e5});
    a.Field("cx_px", cx_px, {.at_least = 0.0, .at_most = 16384.0});
    a.Field("cy_px", cy_px, {.at_least = 0.0, .at_most = 16384.0});
    a.Field("distortion", distortion);
    a.Field("clock_offset_s", clock_offset_s, {.at_least = -1.0, .at_most = 1.0});
    a.Field("period_s", period_s, {.at_least = 0.01, .at_most = 2.0});
    a.Field("max_range_m", max_range_m, {.above = 1.0, .at_most = 500.0});
    a.Field("edge_sigma_px", edge_sigma_px, {.above = 0.0, .at_most = 100.0});
    a.Degrees("pitch_sigma_deg", pitch_sigma_rad, {.above = 0.0, .at_most = 10.0});
    a.Field("detection_probability", detection_probability, {.above = 0.0, .below = 1.0});
    a.Field("clutter_per_image", clutter_per_image, {.above = 0.0, .at_most = 100.0});
    a.Field("min_score", min_score, {.at_least = 0.0, .at_most = 1.0});
    a.Field("covered_bottom_share", covered_bottom_share, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// What the velocity of an object is relative to.
enum class VelocityReference {
  kGround,  ///< Over ground, along the sensor's axes.
  kSensor,  ///< Relative to the moving and turning sensor: how x and y change.
};

/// One source of boxes: a lidar with its detector, a smart camera, another fusion.
struct ObjectSensorConfig {
  std::string name = "LIDAR";  ///< Channel is OBJECTS_<NAME>.
  double x_m = 0.0;            ///< Origin of its frame in B.
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Of its x axis, left positive.
  VelocityReference velocity = VelocityReference::kGround;
  double clock_offset_s = 0.0;
  double period_s = 0.1;
  double half_fov_rad = kPi;  ///< Covered azimuth is +- this.
  double min_range_m = 0.0;
  double max_range_m = 80.0;
  double position_sigma_m = 0.3;            ///< Of a box's centre, per axis, where it tells none.
  double yaw_sigma_rad = FromDegrees(8.0);  ///< Of its axis, likewise.
  double length_sigma_m = 0.4;              ///< Of its size.
  double width_sigma_m = 0.15;
  double velocity_sigma_mps = 0.5;  ///< Of its velocity, per axis, where it tells none.
  double detection_probability = 0.9;
  double clutter_per_frame = 0.5;  ///< Expected false boxes.
  double min_score = 0.3;          ///< Weaker boxes are ignored.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("x_m", x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("y_m", y_m, {.at_least = -5.0, .at_most = 5.0});
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Choice("velocity", velocity,
             {{"ground", VelocityReference::kGround}, {"sensor", VelocityReference::kSensor}});
    a.Field("clock_offset_s", clock_offset_s, {.at_least = -1.0, .at_most = 1.0});
    a.Field("period_s", period_s, {.at_least = 0.01, .at_most = 2.0});
    a.Degrees("half_fov_deg", half_fov_rad, {.above = 0.0, .at_most = 180.0});
    a.Field("min_range_m", min_range_m, {.at_least = 0.0, .at_most = 20.0});
    a.Field("max_range_m", max_range_m, {.above = 1.0, .at_most = 500.0});
    a.Field("position_sigma_m", position_sigma_m, {.above = 0.0, .at_most = 10.0});
    a.Degrees("yaw_sigma_deg", yaw_sigma_rad, {.above = 0.0, .at_most = 90.0});
    a.Field("length_sigma_m", length_sigma_m, {.above = 0.0, .at_most = 10.0});
    a.Field("width_sigma_m", width_sigma_m, {.above = 0.0, .at_most = 5.0});
    a.Field("velocity_sigma_mps", velocity_sigma_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("detection_probability", detection_probability, {.above = 0.0, .below = 1.0});
    a.Field("clutter_per_frame", clutter_per_frame, {.above = 0.0, .at_most = 100.0});
    a.Field("min_score", min_score, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// A sensor's name as calibrations and scenarios spell it behind radar_ or camera_: in lower case.
std::string LowerCaseName(std::string name);

/// The car: its body, its sensors, where its GNSS antenna sits, and what its own instruments are
/// known to be off by. Defaults are the shipped vehicle (daemon/vehicles/vehicle.yaml), which the
/// shipped scenarios drive too.
struct VehicleConfig {
  std::string id;  ///< Which car; a calibration of another one is refused. "" = any.
  double length_m = 4.7;
  double width_m = 1.85;
  double centre_x_m = 1.4;   ///< Centre of the footprint in B, ahead of the rear axle.
  double antenna_x_m = 0.8;  ///< GNSS antenna in B.
  double antenna_y_m = 0.0;
  double gnss_latency_s = 0.0;       ///< How much older a fix is than its stamp says.
  double speed_scale = 1.0;          ///< Of the odometer: measured = scale x true.
  double yaw_rate_bias_radps = 0.0;  ///< Of the gyro: measured = true + bias, left positive.
  double heading_bias_rad = 0.0;     ///< Of the GNSS receiver's heading: likewise.
  std::vector<RadarConfig> radars = DefaultRadars();
  std::vector<CameraConfig> cameras = {CameraConfig{}};
  std::vector<ObjectSensorConfig> objects{};

  /// How many sensors of a kind there are.
  [[nodiscard]] int SensorsOf(SensorKind kind) const;
  /// All of them: radars, cameras, sources of objects, each in the order of their list.
  [[nodiscard]] std::vector<SensorKey> AllSensors() const;
  /// "" for one that is not there.
  [[nodiscard]] std::string NameOf(SensorKey sensor) const;
  /// Nominal; 0 for one that is not there, as the next.
  [[nodiscard]] double PeriodOf(SensorKey sensor) const;
  /// Of a car in clear view at close range.
  [[nodiscard]] double DetectionProbabilityOf(SensorKey sensor) const;

  /// One long-range radar ahead, two short-range radars at the front corners; the rear is not
  /// watched.
  static std::vector<RadarConfig> DefaultRadars();

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("id", id);
    a.Field("length_m", length_m, {.at_least = 0.5, .at_most = 30.0});
    a.Field("width_m", width_m, {.at_least = 0.3, .at_most = 5.0});
    a.Field("centre_x_m", centre_x_m, {.at_least = -15.0, .at_most = 15.0});
    a.Field("antenna_x_m", antenna_x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("antenna_y_m", antenna_y_m, {.at_least = -5.0, .at_most = 5.0});
    a.Field("gnss_latency_s", gnss_latency_s, {.at_least = -1.0, .at_most = 1.0});
    a.Field("speed_scale", speed_scale, {.at_least = 0.9, .at_most = 1.1});
    a.Degrees("yaw_rate_bias_degps", yaw_rate_bias_radps, {.at_least = -5.0, .at_most = 5.0});
    a.Degrees("heading_bias_deg", heading_bias_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Field("radars", radars);
    a.Field("cameras", cameras);
    a.Field("objects", objects);
  }
};

}  // namespace v2vouch
