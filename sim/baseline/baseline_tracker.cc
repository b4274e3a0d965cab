// SPDX-License-Identifier: Apache-2.0
#include "sim/baseline/baseline_tracker.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/object_class.h"

namespace v2vouch::baseline {
namespace {

constexpr double kGate_m = 4.0;
constexpr double kAccel_mps2 = 2.0;
constexpr double kFace_m = 0.5, kAcross_m = 0.5;
constexpr double kGone_s = 0.6;
constexpr int kMovingHits = 5, kCameraHits = 3;

struct Size {
  double length_m, width_m;
};

Size SizeOf(int object_class) {
  switch (object_class) {
    case track_t::CLASS_VAN:
      return {5.3, 2.0};
    case track_t::CLASS_TRUCK:
    case track_t::CLASS_BUS:
      return {10.0, 2.5};
    case track_t::CLASS_MOTORCYCLE:
    case track_t::CLASS_CYCLIST:
      return {2.0, 0.8};
    case track_t::CLASS_PEDESTRIAN:
      return {0.6, 0.6};
    default:
      return {4.5, 1.8};
  }
}

double Seconds(std::int64_t us) { return 1e-6 * static_cast<double>(us); }

void AddSource(std::int8_t kind, std::int64_t utime, track_t& track) {
  if (utime == 0) return;
  track_source_t source;
  source.kind = kind;
  source.last_utime = utime;
  track.sources.push_back(source);
  track.num_sources = static_cast<std::int32_t>(track.sources.size());
}

}  // namespace

BaselineTracker::BaselineTracker(const VehicleConfig& vehicle) : vehicle_(vehicle) {}

BaselineTracker::Vec2 BaselineTracker::ToBody(const Vec2& p_O) const {
  const Vec2 d = p_O - ego_O_;
  const Vec2 ahead = Direction(yaw_O_);
  return {ahead.dot(d), ahead.x() * d.y() - ahead.y() * d.x()};
}

BaselineTracker::Vec2 BaselineTracker::ToOdometry(const Vec2& p_B) const {
  const Vec2 ahead = Direction(yaw_O_);
  return ego_O_ + p_B.x() * ahead + p_B.y() * Vec2(-ahead.y(), ahead.x());
}

void BaselineTracker::MoveEgo(std::int64_t utime) {
  if (utime <= utime_) return;
  const double dt = std::min(0.5, Seconds(utime - utime_));
  if (utime_ != 0) {
    ego_O_ += dt * speed_mps_ * Direction(yaw_O_ + 0.5 * dt * yaw_rate_radps_);
    yaw_O_ += dt * yaw_rate_radps_;
  }
  utime_ = utime;
}

void BaselineTracker::TakeMotion(const ego_motion_t& motion) {
  MoveEgo(motion.utime);
  motion_utime_ = motion.utime;
  speed_mps_ = motion.speed_mps / vehicle_.speed_scale;
  if (std::isfinite(motion.yaw_rate_radps)) {
    yaw_rate_radps_ = motion.yaw_rate_radps - vehicle_.yaw_rate_bias_radps;
  }
}

void BaselineTracker::Predict(std::int64_t utime) {
  for (Track& track : tracks_) {
    const double dt = Seconds(utime - track.utime);
    if (dt <= 0.0) continue;
    Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
    F(0, 2) = F(1, 3) = dt;
    const double q = kAccel_mps2 * kAccel_mps2;
    Eigen::Matrix4d Q = Eigen::Matrix4d::Zero();
    for (int k = 0; k < 2; ++k) {
      Q(k, k) = q * dt * dt * dt / 3.0;
      Q(k, k + 2) = Q(k + 2, k) = q * dt * dt / 2.0;
      Q(k + 2, k + 2) = q * dt;
    }
    track.x = F * track.x;
    track.P = F * track.P * F.transpose() + Q;
    track.utime = utime;
  }
}

BaselineTracker::Vec2 BaselineTracker::CentreOf(const Cluster& cluster, double yaw_rad,
                                                int object_class) const {
  const Vec2 way = (cluster.face_O - cluster.sensor_O).normalized();
  const Size size = SizeOf(object_class);
  const double cosine = std::abs(way.dot(Direction(yaw_rad)));
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  // From the near outline to the centre of the box along the line of sight.
  const double half = std::min(cosine > 1e-3 ? 0.5 * size.length_m / cosine : 1e3,
                               sine > 1e-3 ? 0.5 * size.width_m / sine : 1e3);
  return cluster.face_O + half * way;
}

void BaselineTracker::Update(const RadarConfig& radar, const Cluster& cluster, Track& track) const {
  const Vec2 way = (cluster.face_O - cluster.sensor_O).normalized();
  const Vec2 across(-way.y(), way.x());
  const double range = (cluster.face_O - cluster.sensor_O).norm();
  const double sigma_across = std::hypot(kAcross_m, range * radar.azimuth_sigma_rad);
  const double sigma_along = std::hypot(kFace_m, radar.range_sigma_m);
  const auto update = [&](const Vec4& h, double error, double sigma) {
    const double s = h.dot(track.P * h) + sigma * sigma;
    const Vec4 k = track.P * h / s;
    track.x += k * error;
    track.P -= k * h.transpose() * track.P;
    track.P = 0.5 * (track.P + track.P.transpose()).eval();
  };
  const Vec2 error = CentreOf(cluster, track.yaw_rad, track.object_class) - track.x.head<2>();
  update({way.x(), way.y(), 0.0, 0.0}, way.dot(error), sigma_along);
  update({across.x(), across.y(), 0.0, 0.0}, across.dot(error), sigma_across);
  const double rate = way.dot(track.x.tail<2>() - cluster.sensor_velocity_O);
  update({0.0, 0.0, way.x(), way.y()}, cluster.rate_mps - rate,
         std::hypot(0.3, radar.range_rate_sigma_mps));
  const Vec2 velocity = track.x.tail<2>();
  if (velocity.norm() > kMoving_mps) track.yaw_rad = std::atan2(velocity.y(), velocity.x());
  track.radar_utime = utime_;
  ++track.radar_hits;
}

void BaselineTracker::Start(const Cluster& cluster) {
  const Vec2 way = (cluster.face_O - cluster.sensor_O).normalized();
  const double along = cluster.rate_mps + way.dot(cluster.sensor_velocity_O);
  Track track{};
  track.id = next_id_++;
  track.yaw_rad = std::atan2(along < 0.0 ? -way.y() : way.y(), along < 0.0 ? -way.x() : way.x());
  track.object_class = track_t::CLASS_UNKNOWN;
  track.x.head<2>() = CentreOf(cluster, track.yaw_rad, track.object_class);
  track.x.tail<2>() = along * way;
  const double across = cluster.is_moving ? 5.0 : 0.5;
  const Vec2 side(-way.y(), way.x());
  track.P.setZero();
  track.P.topLeftCorner<2, 2>().setIdentity();
  track.P.bottomRightCorner<2, 2>() =
      0.25 * way * way.transpose() + across * across * side * side.transpose();
  track.start_utime = track.utime = track.radar_utime = utime_;
  track.radar_hits = 1;
  tracks_.push_back(track);
}

void BaselineTracker::Forget() {
  std::erase_if(tracks_, [&](const Track& track) {
    return Seconds(utime_ - std::max(track.radar_utime, track.camera_utime)) > kGone_s ||
           !track.x.allFinite();
  });
}

void BaselineTracker::TakeRadar(const RadarConfig& radar, const radar_scan_t& scan) {
  MoveEgo(scan.utime);
  Predict(utime_);
  Forget();
  std::vector<Cluster> clusters =
      ClustersOf(radar, scan, {ego_O_, yaw_O_, speed_mps_, yaw_rate_radps_});
  for (Track& track : tracks_) {
    Cluster* nearest = nullptr;
    double least = kGate_m;
    for (Cluster& cluster : clusters) {
      const double off =
          (CentreOf(cluster, track.yaw_rad, track.object_class) - track.x.head<2>()).norm();
      if (cluster.is_taken || off >= least) continue;
      least = off;
      nearest = &cluster;
    }
    if (nearest == nullptr) continue;
    nearest->is_taken = true;
    Update(radar, *nearest, track);
    const bool moves = track.x.tail<2>().norm() > 2.0 * kMoving_mps;
    if (moves && track.radar_hits >= kMovingHits) track.is_confirmed = true;
  }
  for (const Cluster& cluster : clusters) {
    const bool is_near_track = std::ranges::any_of(tracks_, [&](const Track& track) {
      return (track.x.head<2>() - cluster.face_O).norm() < kGate_m;
    });
    if (!cluster.is_taken && !is_near_track) Start(cluster);
  }
}

void BaselineTracker::TakeCamera(const CameraConfig& camera, const camera_detections_t& picture) {
  MoveEgo(picture.utime);
  Predict(utime_);
  const Vec2 camera_O = ToOdometry({camera.x_m, camera.y_m});
  for (const camera_box_t& box : picture.boxes) {
    if (!(box.width_px > 0.0) || (box.score > 0.0 && box.score < camera.min_score)) continue;
    const auto bearing = [&](double x_px) {
      return yaw_O_ + camera.yaw_rad - std::atan2(x_px - camera.cx_px, camera.fx_px);
    };
    const double middle = bearing(box.left_px + 0.5 * box.width_px);
    const double half = 0.5 * std::abs(bearing(box.left_px) - bearing(box.left_px + box.width_px));
    Track* nearest = nullptr;
    for (Track& track : tracks_) {
      const Vec2 way = track.x.head<2>() - camera_O;
      const double off = std::abs(WrapAngle(std::atan2(way.y(), way.x()) - middle));
      if (off > half + FromDegrees(1.0)) continue;
      if (nearest == nullptr || way.norm() < (nearest->x.head<2>() - camera_O).norm()) {
        nearest = &track;
      }
    }
    if (nearest == nullptr) continue;
    nearest->camera_utime = utime_;
    for (int read = track_t::CLASS_CAR; read <= track_t::CLASS_CYCLIST; ++read) {
      if (ObjectClassName(static_cast<ObjectClass>(read)) == box.class_name) {
        nearest->object_class = read;
      }
    }
    if (nearest->radar_hits >= kCameraHits) nearest->is_confirmed = true;
  }
}

track_list_t BaselineTracker::List() const {
  track_list_t list{};
  list.utime = utime_;
  list.ego_x_odom_m = ego_O_.x();
  list.ego_y_odom_m = ego_O_.y();
  list.ego_yaw_odom_rad = yaw_O_;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const Track& track : tracks_) {
    if (!track.is_confirmed) continue;
    track_t out{};
    const Vec2 velocity = track.x.tail<2>();
    const Vec2 centre = ToBody(track.x.head<2>() + Seconds(utime_ - track.utime) * velocity);
    out.id = track.id;
    out.start_utime = track.start_utime;
    out.x_body_m = centre.x();
    out.y_body_m = centre.y();
    out.yaw_body_rad = WrapAngle(track.yaw_rad - yaw_O_);
    out.speed_mps = velocity.dot(Direction(track.yaw_rad));
    const Eigen::Rotation2Dd R_BO(-yaw_O_);
    const Eigen::Matrix2d P = R_BO.toRotationMatrix() * track.P.topLeftCorner<2, 2>() *
                              R_BO.toRotationMatrix().transpose();
    out.covariance_body[0] = P(0, 0);
    out.covariance_body[1] = out.covariance_body[6] = P(0, 1);
    out.covariance_body[7] = P(1, 1);
    const Size size = SizeOf(track.object_class);
    out.length_m = size.length_m;
    out.width_m = size.width_m;
    out.object_class = static_cast<std::int8_t>(track.object_class);
    out.existence = 1.0;
    out.is_confirmed = 1;
    AddSource(track_source_t::RADAR, track.radar_utime, out);
    AddSource(track_source_t::CAMERA, track.camera_utime, out);
    out.bridge_budget_s = out.latitude_rad = out.longitude_rad = kNone;
    out.bias_east_m = out.bias_north_m = kNone;
    list.tracks.push_back(out);
  }
  list.num_tracks = static_cast<std::int32_t>(list.tracks.size());
  list.num_sectors = 0;
  return list;
}

}  // namespace v2vouch::baseline
