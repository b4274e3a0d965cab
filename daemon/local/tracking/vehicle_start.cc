// SPDX-License-Identifier: Apache-2.0
// How a vehicle begins: from a point that moves, or from one that stands and may lie along any
// axis.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/local/tracking/initial_sigmas.h"
#include "daemon/local/tracking/vehicle_filter.h"

namespace v2vouch {
namespace {

// Axes of a standing vehicle: most stand along the road or across it.
constexpr std::array<double, VehicleFilter::kMostAxes> kAxisWeight = {0.4, 0.3, 0.15, 0.15};
constexpr std::array<double, VehicleFilter::kMostAxes> kAxisTurn_rad = {0.0, kPi / 2, kPi / 4,
                                                                        -kPi / 4};
constexpr double kAxisSigma_rad = 0.25;

}  // namespace

// Centre = point - offset of the reflections, with the derivatives that tie the centre to direction
// and size.
ExtendedState VehicleAt(const PointFilter& point, double yaw_rad, double yaw_sigma_rad,
                        const Extent& size, const Eigen::Vector2d& seen_from_O,
                        const FilterSettings& settings) {
  const bool has_direction = yaw_sigma_rad == 0.0;
  const Eigen::Vector2d v = point.velocity();
  const double yaw = has_direction ? std::atan2(v.y(), v.x()) : yaw_rad;
  const Eigen::Vector2d forward(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d p_SQ = point.position() - seen_from_O;

  // Offset in axes of O, with the sensor seen from the point instead of from the centre: both lie
  // on nearly the same line. The distance is stretched by half a width, where the centre is.
  const double range = std::max(p_SQ.norm(), 0.5);
  const auto offset_O = [&](const Eigen::Vector2d& ahead, const Extent& extent) -> Eigen::Vector2d {
    if (settings.point_targets) return Eigen::Vector2d::Zero();
    const Eigen::Vector2d p_OS = -p_SQ * (1.0 + 0.5 * extent.width_m / range);
    Eigen::Matrix2d R_OT;
    R_OT << ahead.x(), -ahead.y(), ahead.y(), ahead.x();
    return R_OT * ReflectionOffset(p_OS, ahead, extent);
  };
  ExtendedState out;
  const Eigen::Vector2d offset = offset_O(forward, size);
  const Eigen::Vector2d centre = point.position() - offset;
  const double speed = has_direction ? v.norm() : v.dot(forward);
  out.mean << centre, yaw, speed, 0.0, 0.0, size.length_m, size.width_m, 0.0, 0.0;

  // Inputs: point, velocity, yaw (where only assumed), length, width.
  Eigen::Matrix<double, ExtendedState::kSize, 7> J =
      Eigen::Matrix<double, ExtendedState::kSize, 7>::Zero();
  const double h = 1e-4;
  const auto turned = [yaw](double by) {
    return Eigen::Vector2d(std::cos(yaw + by), std::sin(yaw + by));
  };
  const Eigen::Vector2d by_yaw =
      (offset_O(turned(h), size) - offset_O(turned(-h), size)) / (2.0 * h);
  Extent longer = size, wider = size;
  longer.length_m += h;
  wider.width_m += h;
  J.topLeftCorner<2, 2>().setIdentity();
  J.block<2, 1>(0, 5) = -(offset_O(forward, longer) - offset) / h;
  J.block<2, 1>(0, 6) = -(offset_O(forward, wider) - offset) / h;
  J.block<1, 2>(kSpeed, 2) = forward.transpose();
  J(ExtendedState::kLength, 5) = 1.0;
  J(ExtendedState::kWidth, 6) = 1.0;
  Eigen::Matrix<double, 7, 7> P = Eigen::Matrix<double, 7, 7>::Zero();
  P.topLeftCorner<4, 4>() = point.covariance();
  if (has_direction) {
    const Eigen::RowVector2d yaw_by_v =
        Eigen::RowVector2d(-v.y(), v.x()) / std::max(v.squaredNorm(), 1e-6);
    J.block<1, 2>(kYaw, 2) = yaw_by_v;
    J.block<2, 2>(0, 2) = -by_yaw * yaw_by_v;
  } else {
    J(kYaw, 4) = 1.0;
    J.block<2, 1>(0, 4) = -by_yaw;
    P(4, 4) = yaw_sigma_rad * yaw_sigma_rad;
  }
  P(5, 5) = size.length_sigma_m * size.length_sigma_m;
  P(6, 6) = size.width_sigma_m * size.width_sigma_m;
  const Eigen::Matrix<double, ExtendedState::kSize, 7> JP = J.lazyProduct(P);
  out.covariance = JP.lazyProduct(J.transpose());
  out.covariance(kYawRate, kYawRate) = kInitialYawRateSigma_radps * kInitialYawRateSigma_radps;
  out.covariance(kAccel, kAccel) = kInitialAccelSigma_mps2 * kInitialAccelSigma_mps2;
  AssumeOffsets(out);
  return out;
}

void FaceAbout(ExtendedState& state) {
  state.mean[kYaw] = WrapAngle(state.mean[kYaw] + kPi);
  for (const int k : {static_cast<int>(kSpeed), static_cast<int>(kAccel)}) {
    state.mean[k] = -state.mean[k];
    state.covariance.row(k) *= -1.0;
    state.covariance.col(k) *= -1.0;
  }
}

VehicleFilter& VehicleFilter::operator=(const VehicleFilter& other) {
  std::copy_n(other.components_.begin(), other.count_, components_.begin());
  count_ = other.count_;
  has_driven_ = other.has_driven_;
  is_size_open_ = other.is_size_open_;
  odd_boxes_ = other.odd_boxes_;
  odd_spans_ = other.odd_spans_;
  is_deep_ = other.is_deep_;
  usual_depth_ = other.usual_depth_;
  return *this;
}

void VehicleFilter::StartMoving(const PointFilter& point, const Extent& size,
                                const Eigen::Vector2d& seen_from_O,
                                const FilterSettings& settings) {
  components_[0] = {VehicleAt(point, 0.0, 0.0, size, seen_from_O, settings), 1.0};
  count_ = 1;
  has_driven_ = true;
}

void VehicleFilter::StartStanding(const PointFilter& point, double likely_yaw_rad,
                                  const Extent& size, const Eigen::Vector2d& seen_from_O,
                                  const FilterSettings& settings) {
  count_ = kMostAxes;
  for (std::size_t i = 0; i < kMostAxes; ++i) {
    const double yaw = WrapAngle(likely_yaw_rad + kAxisTurn_rad[i]);
    components_[i] = {VehicleAt(point, yaw, kAxisSigma_rad, size, seen_from_O, settings),
                      kAxisWeight[i]};
  }
  has_driven_ = false;
}

}  // namespace v2vouch
