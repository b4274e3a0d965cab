// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/cluster_owner.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/outline.h"
#include "daemon/common/models/extent.h"

namespace v2vouch {
namespace {

// A cluster belongs to a vehicle up to this far outside of its box, plus its own noise.
constexpr double kBoxMargin_m = 0.5;
constexpr double kStandingMargin_m = 0.3;
// Ahead and behind vehicles keep more distance than this from each other.
constexpr double kEndMargin_m = 1.5;
constexpr double kMaxBlur_m = 1.5;
// A vehicle whose length is open does not own what lies a car's length off.
constexpr double kMostDoubt_m = 1.5;
// While a vehicle's direction is unknown, this round its reflecting point.
constexpr double kPointRadius_m = 2.5;
// Parts of one rigid body move as one; wheels and limbs of the model do not.
constexpr double kRangeRateSlack_mps = 1.5;
// A face answers this much stronger than what lies inside of a vehicle.
constexpr double kFaceStronger_db = 10.0;
// ... and lies before the vehicle's middle, not where the one beside it may stand.
constexpr double kFaceAside = 0.25;
// Tracks that are hardly believed own what lies near them only while they are being hit.
constexpr double kOwnerExistence = 0.5;
// A lorry or bus whose length is not known yet may reach this many sigmas farther.
constexpr double kLongReachSigmas = 2.0;

// How far from its centre a vehicle may reflect along its axis.
double ReachAlong(const LocalTrack& track) {
  const Extent& extent = track.extent;
  if (!IsLong(track.object_class))
    return 0.5 * extent.length_m + std::min(extent.length_sigma_m, kMostDoubt_m) + kEndMargin_m;
  return std::min(0.5 * extent.length_m + kLongReachSigmas * extent.length_sigma_m,
                  kLongestVehicle_m - 0.5 * extent.length_m) +
         kEndMargin_m;
}

}  // namespace

RadarMeasurement JoinClusters(const RadarMeasurement& a, const RadarMeasurement& b,
                              const Eigen::Vector2d& v_TA_R) {
  const double na = std::max(a.returns, 1);
  const double nb = std::max(b.returns, 1);
  const auto far = [](const RadarMeasurement& z) { return z.near_range_m + z.radial_extent_m; };
  RadarMeasurement out = a;
  out.returns = a.returns + b.returns;
  double wa = na / (na + nb);
  const double middle_share = 1.0 - wa;
  if (a.outline_count > 0 && b.outline_count > 0) {
    std::array<OutlineReturn, 2 * RadarMeasurement::kMostOutline> both;
    const auto middle = std::copy_n(a.outline.begin(), a.outline_count, both.begin());
    std::copy_n(b.outline.begin(), b.outline_count, middle);
    const auto kept = KeepOutline(std::span(both).first(a.outline_count + b.outline_count));
    out.outline_count = std::min(kept, RadarMeasurement::kMostOutline);
    std::copy_n(both.begin(), out.outline_count, out.outline.begin());
    double from_a = 0.0;
    for (std::size_t k = 0; k < out.outline_count; ++k) {
      for (std::size_t m = 0; m < a.outline_count; ++m) {
        if (out.outline[k].range_m == a.outline[m].range_m &&
            out.outline[k].azimuth_rad == a.outline[m].azimuth_rad) {
          from_a += 1.0;
          break;
        }
      }
    }
    wa = from_a / static_cast<double>(out.outline_count);
  }
  const double wb = 1.0 - wa;
  out.range_m = wa * a.range_m + wb * b.range_m;
  out.azimuth_rad = WrapAngle(a.azimuth_rad + wb * AngleDifference(b.azimuth_rad, a.azimuth_rad));
  out.middle_azimuth_rad =
      a.middle_azimuth_rad +
      middle_share * AngleDifference(b.middle_azimuth_rad, a.middle_azimuth_rad);
  out.ground_range_rate_mps = wa * a.ground_range_rate_mps + wb * b.ground_range_rate_mps;
  const auto expected = [&](double azimuth_rad) {
    return v_TA_R.dot(Eigen::Vector2d(std::cos(azimuth_rad), std::sin(azimuth_rad)));
  };
  out.range_rate_mps = expected(out.azimuth_rad) +
                       wa * (a.range_rate_mps - expected(a.azimuth_rad)) +
                       wb * (b.range_rate_mps - expected(b.azimuth_rad));
  out.covariance = wa * wa * a.covariance + wb * wb * b.covariance;
  out.near_range_m = std::min(a.near_range_m, b.near_range_m);
  out.radial_extent_m = std::max(far(a), far(b)) - out.near_range_m;
  out.azimuth_min_rad = std::min(a.azimuth_min_rad, b.azimuth_min_rad);
  out.azimuth_max_rad = std::max(a.azimuth_max_rad, b.azimuth_max_rad);
  out.is_static = a.is_static && b.is_static;
  return out;
}

bool IsPartOf(TrackTable::ConstRow row, const RadarLook& look, const RadarMeasurement& z,
              const Eigen::Vector2d& p_O) {
  const auto& [track, evidence] = row;
  const TrackFilter& filter = evidence.filter;
  const StateVector& x = track.state_O.mean;
  const double blur_m =
      std::min(2.0 * (std::sqrt(z.covariance(0, 0)) + z.range_m * std::sqrt(z.covariance(1, 1))),
               kMaxBlur_m);
  const Eigen::Vector2d from_point = p_O - filter.position_O();
  Eigen::Vector2d turning = Eigen::Vector2d::Zero();
  if (filter.is_vehicle()) {
    const Eigen::Vector2d inside = Eigen::Rotation2D<double>(-x[kYaw]) * from_point;
    const Extent& extent = track.extent;
    // What stands near a standing vehicle need not belong to it.
    const double reach = z.is_static ? 0.5 * extent.length_m : ReachAlong(track) + blur_m;
    // A sensor that tracks by itself has found out which returns are one vehicle.
    const double aside = z.is_static   ? kStandingMargin_m
                         : z.is_object ? 0.0
                                       : kBoxMargin_m + blur_m;
    if (std::abs(inside.x()) > reach || std::abs(inside.y()) > 0.5 * extent.width_m + aside) {
      return false;
    }
    turning = x[kYawRate] * Eigen::Vector2d(-from_point.y(), from_point.x());
  } else if (z.is_static || from_point.norm() > kPointRadius_m + blur_m) {
    return false;
  }
  const Eigen::Vector2d line = (p_O - look.origin_O()).normalized();
  const Eigen::Vector2d velocity = filter.velocity_O() + turning;
  const double slack = kRangeRateSlack_mps + 3.0 * std::sqrt(z.covariance(2, 2));
  return std::abs(line.dot(velocity) - z.ground_range_rate_mps) <= slack;
}

bool IsPartOf(const LocalTrack& track, const CameraLook& look, const CameraMeasurement& z,
              const Fix& fix) {
  if (track.existence < kOwnerExistence) return false;
  const StateVector& x = track.state_O.mean;
  const Eigen::Vector2d line = x.head<2>() - look.origin_O();
  const double range_m = line.norm();
  if (range_m < 1.0) return true;
  const double bearing =
      WrapAngle(std::atan2(line.y(), line.x()) - look.ego.X_OB.yaw_rad() - look.camera.yaw_rad);
  const double half = 0.5 * std::hypot(track.extent.length_m, track.extent.width_m) / range_m;
  const double overlap =
      std::min(z.azimuth_left_rad, bearing + half) - std::max(z.azimuth_right_rad, bearing - half);
  if (overlap < 0.5 * (z.azimuth_left_rad - z.azimuth_right_rad)) return false;
  const double fix_range_m = (fix.p_O - look.origin_O()).norm();
  const Eigen::Vector2d u = line / range_m;
  const double range_sigma = std::sqrt(u.dot(fix.covariance * u));
  return std::abs(fix_range_m - range_m) < 3.0 * range_sigma + 0.5 * track.extent.length_m + 1.0;
}

void ClusterOwners::Find(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                         const TrackTable& table, const Association& association) {
  FindByPlace(look, measurements, table, association);
  FindFaces(look, measurements, table, association);
  Join(look, measurements, table, association);
}

// Every cluster that was assigned, or that lies in a tracked vehicle's box.
void ClusterOwners::FindByPlace(const RadarLook& look,
                                std::span<const RadarMeasurement> measurements,
                                const TrackTable& table, const Association& association) {
  const Candidates& candidates = association.candidates();
  owner_.assign(measurements.size(), kNobody);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (const auto given = association.GivenTo(i)) owner_[*given] = kAssigned;
  }
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    if (!association.GivenTo(i) && track.existence < kOwnerExistence) continue;
    const double reach_m = ReachAlong(track) + track.extent.width_m + kPointRadius_m + kMaxBlur_m;
    candidates.ForEachNear(evidence.filter.position_O(), reach_m, [&](std::size_t j) {
      if (IsOwned(j)) return;
      if (IsPartOf(table[i], look, measurements[j], candidates[j].p_O)) {
        owner_[j] = static_cast<int>(i);
      }
    });
  }
}

// A standing vehicle that a camera has named may have been given what lies inside of it, or what
// stands behind: a clearly stronger standing cluster before that, in its silhouette, is its face.
void ClusterOwners::FindFaces(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                              const TrackTable& table, const Association& association) {
  const Candidates& candidates = association.candidates();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    const auto assigned = association.GivenTo(i);
    if (!assigned || track.camera_hits() == 0 || !evidence.filter.is_vehicle()) continue;
    const RadarMeasurement& given = measurements[*assigned];
    if (!given.is_static || given.outline_count == 0) continue;
    const Eigen::Vector2d line = evidence.filter.position_O() - look.origin_O();
    const Eigen::Vector2d u = line / std::max(line.norm(), 0.1);
    const double yaw_rad = track.state_O.mean[kYaw];
    const Eigen::Vector2d forward(std::cos(yaw_rad), std::sin(yaw_rad));
    const double sine = std::abs(forward.x() * u.y() - forward.y() * u.x());
    const double cosine = std::abs(forward.dot(u));
    const Extent& extent = track.extent;
    const double deep_m = cosine * extent.length_m + sine * extent.width_m;
    const double reach_m = deep_m + extent.length_m;
    candidates.ForEachNear(evidence.filter.position_O(), reach_m, [&](std::size_t j) {
      const RadarMeasurement& z = measurements[j];
      if (IsOwned(j) || !z.is_static || z.outline_count == 0) return;
      if (z.outline[0].strength_db < given.outline[0].strength_db + kFaceStronger_db) return;
      const double before_m = given.range_m - z.range_m;
      if (before_m < 0.0 || before_m > deep_m) return;
      const Eigen::Vector2d off = candidates[j].p_O - look.origin_O();
      if (std::abs(u.x() * off.y() - u.y() * off.x()) > kFaceAside * extent.width_m) return;
      owner_[j] = static_cast<int>(i);
    });
  }
}

// What each track was given, with the clusters that belong to it.
void ClusterOwners::Join(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                         const TrackTable& table, const Association& association) {
  const Eigen::Vector2d v_A_B = AntennaVelocity_B(look.ego, look.radar);
  const Eigen::Matrix2d R_BO = look.ego.X_OB.rotation().transpose();
  const Eigen::Rotation2Dd R_RB(-look.radar.yaw_rad);
  joined_.resize(table.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (const auto given = association.GivenTo(i)) joined_[i] = measurements[*given];
  }
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (owner_[j] < 0 || owner_[j] == kAssigned || measurements[j].is_object) continue;
    const auto owner = static_cast<std::size_t>(owner_[j]);
    if (!association.GivenTo(owner)) continue;
    // An echo starts nothing, but it is no part of the body either: it would lengthen it.
    if (association.candidates()[j].is_echo) continue;
    const Eigen::Vector2d velocity_O = table[owner].evidence.filter.velocity_O();
    const Eigen::Vector2d v_TA_R = R_RB * (R_BO * velocity_O - v_A_B);
    joined_[owner] = JoinClusters(joined_[owner], measurements[j], v_TA_R);
  }
}

}  // namespace v2vouch
