// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/sensor.h"
#include "daemon/common/geodesy/wgs84.h"

namespace v2vouch {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What the camera or a sender calls an object. Values are those of track_t.
enum class ObjectClass : std::int8_t {
  kUnknown = 0,
  kCar = 1,
  kVan = 2,
  kTruck = 3,
  kBus = 4,
  kMotorcycle = 5,
  kPedestrian = 6,
  kCyclist = 7,
};

/// Two stamps on every message. `stamp` is the time of measurement with the sensor's clock offset
/// applied; `received` is when it arrived (log or socket time), for statistics only.
struct MessageHeader {
  Timestamp stamp{};
  Timestamp received{};
  std::int64_t seq = 0;
};

/// One reflection in the radar's own frame R, sign conventions and range offset already applied.
struct RadarDetection {
  double range_m = 0.0;         ///< From the antenna, > 0.
  double azimuth_rad = 0.0;     ///< From the antenna's x axis, left positive.
  double range_rate_mps = 0.0;  ///< Relative to the moving antenna, away positive.
  double rcs_dbsm = kNaN;       ///< NaN: the sensor has none.
  double snr_db = kNaN;         ///< NaN: the sensor has none.
  int track_id = -1;            ///< The sensor's own object id; -1: a plain reflection.
};

struct RadarScan : MessageHeader {
  int radar = 0;  ///< Index into VehicleConfig::radars.
  std::vector<RadarDetection> detections;
};

/// Box in pixels of the full image: x right, y down.
struct CameraBox {
  double left_px = 0.0;
  double top_px = 0.0;
  double width_px = 0.0;
  double height_px = 0.0;
  ObjectClass object_class = ObjectClass::kUnknown;
  double score = 0.0;  ///< 0..1.
};

struct CameraDetections : MessageHeader {
  int camera = 0;  ///< Index into VehicleConfig::cameras.
  int image_width_px = 0;
  int image_height_px = 0;
  std::vector<CameraBox> boxes;
};

/// One object as another perception reports it, in the sensor's own frame: x ahead, y left.
struct ObjectBox {
  double x_m = 0.0;  ///< Of the footprint's centre.
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< Of its axis, from the sensor's x axis, left positive.
  double length_m = 4.5;
  double width_m = 1.8;
  double yaw_sigma_rad = 0.0;  ///< 0: unknown, as configured; likewise the covariances below.
  double score = 0.0;          ///< 0..1.
  std::int64_t id = -1;        ///< The sensor's own, of one object over time; -1: none.
  /// Variances and covariances of x, y [m^2]; diagonal 0: unknown.
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();
  std::optional<Eigen::Vector2d> velocity_mps{};  ///< As the sensor's configuration says.
  bool has_yaw = true;                            ///< False: unknown; yaw_rad says nothing.
  bool has_front = false;  ///< The end that yaw points to is its front for sure.
  bool has_size = true;    ///< False: unknown; the sizes say nothing.
  ObjectClass object_class = ObjectClass::kUnknown;
};

struct ObjectList : MessageHeader {
  int sensor = 0;  ///< Index into VehicleConfig::objects.
  std::vector<ObjectBox> objects;
};

enum class Gear : std::int8_t { kNeutral = 0, kPark = 1, kForward = 2, kReverse = 3, kUnknown = 7 };

/// Ego odometry in B. Standard deviations beside each value.
struct EgoMotion : MessageHeader {
  double speed_mps = 0.0;  ///< Of the rear axle along x; negative in reverse.
  double speed_sigma_mps = 0.1;
  double yaw_rate_radps = 0.0;  ///< Left positive.
  bool has_yaw_rate = true;     ///< False: unknown; yaw_rate_radps says nothing.
  double yaw_rate_sigma_radps = 0.002;
  std::optional<double> accel_long_mps2;
  std::optional<double> accel_lat_mps2;
  Gear gear = Gear::kUnknown;
};

enum class FixType : std::int8_t {
  kNone = 0,
  k2d = 2,
  k3d = 3,
  kDgnss = 4,
  kRtkFloat = 5,
  kRtkFixed = 6,
};

/// Ego GNSS at the antenna. Directions are yaw angles: counter-clockwise from east.
struct GnssFix : MessageHeader {
  Wgs84 position;
  bool has_height = true;  ///< False: unknown; position.height_m is 0 and says nothing.
  /// [m^2], axes east, north, up; a variance of 0 is unknown.
  Eigen::Matrix3d covariance_enu = Eigen::Matrix3d::Zero();
  std::optional<double>
      yaw_rad;  ///< Of the body's x axis (dual antenna or the receiver's own fusion).
  double yaw_sigma_rad = kNaN;
  std::optional<Eigen::Vector2d> velocity_en_mps;  ///< East, north.
  double velocity_sigma_mps = kNaN;
  FixType fix_type = FixType::kNone;
};

using SenderId = std::uint32_t;  ///< J2735 TemporaryID, first octet most significant.
using CertificateDigest = std::array<std::uint8_t, 8>;

enum class SignatureState : std::int8_t { kUnknown = 0, kValid = 1, kInvalid = 2 };
enum class Transmission : std::int8_t {
  kNeutral = 0,
  kPark = 1,
  kForward = 2,
  kReverse = 3,
  kUnavailable = 7,
};

/// One BSM as received: J2735 integers already turned into SI and radians, sentinels into nullopt.
/// Ranges are J2735's own; nothing has been judged yet. `stamp` is reception time: a claimed time
/// is data, never order.
struct Bsm : MessageHeader {
  SenderId sender = 0;
  CertificateDigest certificate{};
  SignatureState signature = SignatureState::kUnknown;
  std::optional<Timestamp> generation;  ///< IEEE 1609.2 generationTime.
  int msg_count = 0;                    ///< 0..127.
  std::optional<int> sec_mark_ms;       ///< 0..60999 within the UTC minute.
  std::optional<double> latitude_rad;
  std::optional<double> longitude_rad;
  std::optional<double> elevation_m;   ///< Above the ellipsoid.
  std::optional<double> semi_major_m;  ///< 1 sigma.
  std::optional<double> semi_minor_m;  ///< 1 sigma.
  std::optional<double>
      semi_major_yaw_rad;  ///< Direction of semi_major, counter-clockwise from east.
  Transmission transmission = Transmission::kUnavailable;
  std::optional<double> speed_mps;   ///< Never negative; reverse is in `transmission`.
  std::optional<double> course_rad;  ///< Direction of motion, counter-clockwise from east.
  std::optional<double> accel_long_mps2;
  std::optional<double> accel_lat_mps2;
  std::optional<double> yaw_rate_radps;  ///< Left positive (J2735's sign turned round).
  std::optional<double> length_m;
  std::optional<double> width_m;
  TrackEvents events = 0;
  double rssi_dbm = kNaN;
};

using Input = std::variant<RadarScan, CameraDetections, ObjectList, EgoMotion, GnssFix, Bsm>;

/// The stamps of any input.
inline const MessageHeader& HeaderOf(const Input& input) {
  return std::visit([](const auto& message) -> const MessageHeader& { return message; }, input);
}

}  // namespace v2vouch
