// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/ego_motion_t.hpp>
#include <v2vouch/radar_scan_t.hpp>
#include <v2vouch/track_list_t.hpp>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "sim/baseline/radar_clusters.h"

namespace v2vouch::baseline {

/// A tracker as one would write it in an afternoon: the floor that LOCAL must beat in every column.
///
///     radar    returns of a scan in clusters (single link, 1.8 m and 1.5 m/s); of each cluster the
///              nearest return within 10 dB of its strongest is the vehicle's near face
///     motion   constant velocity in the odometry frame, white acceleration 2 m/s^2
///     update   nearest cluster within the gate; range rate beside it
///     camera   a box confirms the nearest track in its bearings and gives the class
///     listed   a moving track after five radar hits in a second, any track after three hits and a
///     box gone     0.6 s without a hit
///
/// The centre is half the class's usual size behind the near face, seen along the velocity (along
/// the line of sight below 1 m/s). Messages are taken in order of arrival; late ones are used as if
/// they were on time.
class BaselineTracker {
 public:
  explicit BaselineTracker(const VehicleConfig& vehicle);

  void TakeMotion(const ego_motion_t& motion);
  void TakeRadar(const RadarConfig& radar, const radar_scan_t& scan);
  void TakeCamera(const CameraConfig& camera, const camera_detections_t& picture);

  /// The confirmed tracks at the time of the newest message.
  [[nodiscard]] track_list_t List() const;
  [[nodiscard]] std::int64_t utime() const { return utime_; }
  [[nodiscard]] bool has_motion() const { return motion_utime_ != 0; }

 private:
  using Vec2 = Eigen::Vector2d;
  using Vec4 = Eigen::Vector4d;
  struct Track {
    std::int64_t id;
    Vec4 x;  ///< Centre and velocity, odometry frame.
    Eigen::Matrix4d P;
    double yaw_rad;
    int object_class;
    std::int64_t start_utime;
    std::int64_t utime;  ///< Of x.
    std::int64_t radar_utime;
    std::int64_t camera_utime = 0;
    int radar_hits = 1;
    bool is_confirmed = false;
  };

  void MoveEgo(std::int64_t utime);
  void Predict(std::int64_t utime);
  void Update(const RadarConfig& radar, const Cluster& cluster, Track& track) const;
  void Start(const Cluster& cluster);
  void Forget();
  [[nodiscard]] Vec2 CentreOf(const Cluster& cluster, double yaw_rad, int object_class) const;
  [[nodiscard]] Vec2 ToBody(const Vec2& p_O) const;
  [[nodiscard]] Vec2 ToOdometry(const Vec2& p_B) const;

  VehicleConfig vehicle_;
  Vec2 ego_O_ = Vec2::Zero();
  double yaw_O_ = 0.0;
  double speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  std::int64_t motion_utime_ = 0;
  std::int64_t utime_ = 0;
  std::int64_t next_id_ = 1;
  std::vector<Track> tracks_;
};

}  // namespace v2vouch::baseline
