// SPDX-License-Identifier: Apache-2.0
#include "daemon/tracking/track_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "daemon/base/angle.h"
#include "daemon/models/dual.h"
#include "daemon/models/kalman.h"

namespace v2vouch {
namespace {

// Across the line of sight one look says nothing about the velocity: road traffic, 1 sigma.
constexpr double kCrossSpeedSigma_mps = 10.0;
constexpr double kCameraSpeedSigma_mps = 8.0;
// White acceleration of a point [m^2/s^3]: 2 m/s^2 that last for about a second.
constexpr double kPointAccelPsd = 4.0;
// One reflection lies anywhere on a vehicle whose direction is unknown: this far from the mean of
// all, radially and across (a car's side scatters by 1.3 m, its tail by 0.5 m). Part of it stays
// however many reflections there are.
constexpr double kReflectionRadialSigma_m = 0.5;
constexpr double kReflectionAcrossSigma_m = 0.9;
constexpr double kPointRadialSigma_m = 0.15;
constexpr double kPointAcrossSigma_m = 0.2;
// A velocity that points somewhere: heading sigma for becoming a vehicle, and for being shown.
constexpr double kDirectedSigma_rad = 0.15;
constexpr double kDirectedSpeedShare = 0.2;
constexpr double kShownSigma_rad = 0.6;
constexpr double kDirectedSpeed_mps = 1.0;
// A direction that was only assumed.
constexpr double kAssumedYawSigma_rad = 0.7;
constexpr double kInitialYawRateSigma_radps = 0.1;
constexpr double kInitialAccelSigma_mps2 = 1.5;
// Young tracks are linearised twice: range rate bends strongly over an uncertain heading.
constexpr double kYoung_s = 0.7;
// The spread of a cluster speaks about the size only where it is not absurd.
constexpr double kSpanGate = 9.0;
// Clusters of a vehicle of which less is visible do not measure its size: what covers it may have
// given them a reflection.
constexpr double kSpanShare = 0.9;
// Seen at a smaller angle than this (its sine), a vehicle's length hides behind its near face:
// what a camera seems to say about it is its own lasting error.
constexpr double kLengthShows = 0.3;
// Of the unseen part of a point target: see LinearizeRadar.
constexpr double kUnseenLooks = 8.0;

using Vector = Linearized::Vector;
using PointJacobian = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, Linearized::kMaxRows, 4>;

struct PointModel {
  Vector y;
  PointJacobian H;
  Linearized::Covariance R;
};

// Noise of a cluster as a measurement of "the" reflecting point.
Eigen::Matrix3d PointNoise(const RadarMeasurement& z, const RadarConfig& radar) {
  Eigen::Matrix3d R = z.covariance;
  const double n = z.is_object ? 16.0 : std::max(z.returns, 1);
  const auto square = [](double a) { return a * a; };
  // The sample's own scatter tells little for a few reflections: the larger of the two counts.
  R(0, 0) = std::max(R(0, 0), (std::min(R(0, 0) * n, square(radar.range_sigma_m)) +
                               square(kReflectionRadialSigma_m)) /
                                  n) +
            square(kPointRadialSigma_m);
  R(1, 1) = std::max(R(1, 1), (std::min(R(1, 1) * n, square(radar.azimuth_sigma_rad)) +
                               square(kReflectionAcrossSigma_m / z.range_m)) /
                                  n) +
            square(kPointAcrossSigma_m / z.range_m);
  const double unseen = kUnseenLooks * square(std::clamp(1.0 - z.visible_share, 0.0, 1.0));
  R(0, 0) += unseen * square(kReflectionRadialSigma_m);
  R(1, 1) += unseen * square(kReflectionAcrossSigma_m / z.range_m);
  return R;
}

std::optional<PointModel> LinearizePoint(const Eigen::Vector4d& x, const RadarLook& look,
                                         const RadarMeasurement& z, bool is_exact) {
  using D = Dual<4>;
  const Pose<Odometry, Radar> X_OR =
      look.ego.X_OB * Pose<Body, Radar>(look.radar.x_m, look.radar.y_m, look.radar.yaw_rad);
  const Eigen::Vector2d v_R_O =
      look.ego.X_OB.rotation() *
      Eigen::Vector2d(look.ego.speed_mps - look.ego.yaw_rate_radps * look.radar.y_m,
                      look.ego.yaw_rate_radps * look.radar.x_m);
  const D qx = D::Variable(x[0] - X_OR.x_m(), 0);
  const D qy = D::Variable(x[1] - X_OR.y_m(), 1);
  const D vx = D::Variable(x[2] - v_R_O.x(), 2);
  const D vy = D::Variable(x[3] - v_R_O.y(), 3);
  const D range = sqrt(qx * qx + qy * qy);
  if (!(range.value > 0.1)) return std::nullopt;
  const D range_rate = (qx * vx + qy * vy) / range;
  const D azimuth = atan2(qy, qx);
  PointModel out;
  out.y.resize(3);
  out.y << z.range_m - range.value, WrapAngle(z.azimuth_rad + X_OR.yaw_rad() - azimuth.value),
      z.range_rate_mps - range_rate.value;
  out.H.resize(3, 4);
  out.H << range.gradient, azimuth.gradient, range_rate.gradient;
  out.R = is_exact ? z.covariance : PointNoise(z, look.radar);
  const Eigen::Vector2d line_B = look.ego.X_OB.rotation().transpose() *
                                 Eigen::Vector2d(qx.value / range.value, qy.value / range.value);
  const double lever = line_B.y() * look.radar.x_m - line_B.x() * look.radar.y_m;
  out.R(2, 2) += std::pow(line_B.x() * look.ego.speed_sigma_mps, 2) +
                 std::pow(lever * look.ego.yaw_rate_sigma_radps, 2);
  return out;
}

std::optional<PointModel> LinearizePoint(const Eigen::Vector4d& x, const CameraLook& look,
                                         const CameraMeasurement& z, bool is_exact) {
  using D = Dual<4>;
  if (z.left_is_cut || z.right_is_cut) return std::nullopt;
  const Pose<Odometry, Camera> X_OC =
      look.ego.X_OB * Pose<Body, Camera>(look.camera.x_m, look.camera.y_m, look.camera.yaw_rad);
  const double c = std::cos(X_OC.yaw_rad());
  const double s = std::sin(X_OC.yaw_rad());
  const D px = D::Variable(x[0] - X_OC.x_m(), 0);
  const D py = D::Variable(x[1] - X_OC.y_m(), 1);
  const D qx = c * px + s * py;
  const D qy = c * py - s * px;
  if (!(qx.value > 0.3)) return std::nullopt;
  const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
  const D bearing = atan2(qy, qx);
  const double range = std::hypot(qx.value, qy.value);
  const int rows = z.bottom_is_cut ? 1 : 2;
  PointModel out;
  out.y.resize(rows);
  out.H.resize(rows, 4);
  out.R.setZero(rows, rows);
  out.y[0] = WrapAngle(middle - bearing.value);
  out.H.row(0) = bearing.gradient;
  const double across = is_exact ? 0.0 : kPointAcrossSigma_m / range;
  out.R(0, 0) = 0.5 * z.azimuth_sigma_rad * z.azimuth_sigma_rad + across * across;
  if (rows == 2) {
    const D depression = atan2(D(look.camera.z_m * std::cos(middle)), qx);
    const double radial = is_exact ? 0.0 : depression.value * 2.0 * kPointRadialSigma_m / qx.value;
    out.y[1] = z.depression_rad - depression.value;
    out.H.row(1) = depression.gradient;
    out.R(1, 1) = z.depression_sigma_rad * z.depression_sigma_rad + radial * radial;
  }
  return out;
}

std::optional<Linearized> LinearizeVehicle(const ExtendedState& state, const Extent& extent,
                                           const RadarLook& look, const RadarMeasurement& z) {
  return LinearizeRadar(state.mean.head<kStateSize>(), extent, look.ego, look.radar, z);
}
std::optional<Linearized> LinearizeVehicle(const ExtendedState& state, const Extent& extent,
                                           const CameraLook& look, const CameraMeasurement& z) {
  return LinearizeCamera(state.mean.head<kStateSize>(), extent, look.ego, look.camera, z);
}

template <class Measurement>
constexpr bool kLearnsSize = std::is_same_v<Measurement, CameraMeasurement>;

// States that a look may not teach, as bits.
unsigned Frozen(const ExtendedState& state, const Eigen::Vector2d& seen_from_O) {
  const Eigen::Vector2d line = (state.mean.head<2>() - seen_from_O).normalized();
  const double aspect = std::atan2(line.y(), line.x()) - state.mean[kYaw];
  return std::abs(std::sin(aspect)) < kLengthShows ? 1U << ExtendedState::kLength : 0U;
}

Extent AssumedExtent(const ExtendedState& state, const FilterSettings& settings) {
  return settings.point_targets ? Extent{0.0, 0.0, 0.0, 0.0} : state.assumed_extent();
}

}  // namespace

Eigen::Vector2d RadarLook::origin_O() const {
  return (ego.X_OB * Point<Body>{radar.x_m, radar.y_m}).vector();
}
Eigen::Vector2d CameraLook::origin_O() const {
  return (ego.X_OB * Point<Body>{camera.x_m, camera.y_m}).vector();
}

Fix FixOf(const RadarLook& look, const RadarMeasurement& z) {
  const double bearing = z.azimuth_rad + look.radar.yaw_rad + look.ego.X_OB.yaw_rad();
  const Eigen::Vector2d line(std::cos(bearing), std::sin(bearing));
  const Eigen::Vector2d across(-line.y(), line.x());
  Eigen::Matrix2d G;  // d(position)/d(range, azimuth)
  G << line, z.range_m * across;
  return {look.origin_O() + z.range_m * line,
          G * z.covariance.topLeftCorner<2, 2>() * G.transpose()};
}

std::optional<Fix> FixOf(const CameraLook& look, const CameraMeasurement& z) {
  if (z.bottom_is_cut || z.left_is_cut || z.right_is_cut) return std::nullopt;
  if (!(z.depression_rad > 1e-3)) return std::nullopt;
  const double middle = 0.5 * (z.azimuth_left_rad + z.azimuth_right_rad);
  const double tangent = std::tan(z.depression_rad);
  const double range = look.camera.z_m / tangent;
  const double range_sigma =
      look.camera.z_m * (1.0 + tangent * tangent) / (tangent * tangent) * z.depression_sigma_rad;
  const double bearing = middle + look.camera.yaw_rad + look.ego.X_OB.yaw_rad();
  const Eigen::Vector2d line(std::cos(bearing), std::sin(bearing));
  const Eigen::Vector2d across(-line.y(), line.x());
  const double across_sigma = range * z.azimuth_sigma_rad + kPointAcrossSigma_m;
  const double along_sigma = range_sigma + kPointRadialSigma_m;
  return Fix{look.origin_O() + range * line,
             along_sigma * along_sigma * line * line.transpose() +
                 across_sigma * across_sigma * across * across.transpose()};
}

TrackFilter TrackFilter::FromRadar(const RadarLook& look, const RadarMeasurement& z,
                                   const FilterSettings& settings) {
  TrackFilter filter;
  const Fix fix = FixOf(look, z);
  filter.seen_from_ = look.origin_O();
  filter.default_yaw_rad_ = look.ego.X_OB.yaw_rad();
  const Eigen::Vector2d line = (fix.p_O - filter.seen_from_).normalized();
  const Eigen::Vector2d across(-line.y(), line.x());
  const double radial_sigma = std::sqrt(z.covariance(2, 2)) + look.ego.speed_sigma_mps + 0.1;
  filter.point_ << fix.p_O, z.ground_range_rate_mps * line;
  filter.point_covariance_.setZero();
  RadarMeasurement blurred = z;
  blurred.covariance = settings.point_targets ? z.covariance : PointNoise(z, look.radar);
  filter.point_covariance_.topLeftCorner<2, 2>() = FixOf(look, blurred).covariance;
  filter.point_covariance_.bottomRightCorner<2, 2>() =
      radial_sigma * radial_sigma * line * line.transpose() +
      kCrossSpeedSigma_mps * kCrossSpeedSigma_mps * across * across.transpose();
  return filter;
}

TrackFilter TrackFilter::FromCamera(const CameraLook& look, const CameraMeasurement& z,
                                    const Fix& fix) {
  TrackFilter filter;
  filter.seen_from_ = look.origin_O();
  filter.default_yaw_rad_ = look.ego.X_OB.yaw_rad();
  // A silhouette that is longer than any vehicle is wide shows a side: it stands across the view.
  const double width_m =
      (z.azimuth_left_rad - z.azimuth_right_rad) * (fix.p_O - filter.seen_from_).norm();
  if (width_m > 3.2 && z.object_class != ObjectClass::kTruck &&
      z.object_class != ObjectClass::kBus) {
    filter.default_yaw_rad_ = WrapAngle(filter.default_yaw_rad_ + 0.5 * kPi);
  }
  filter.point_ << fix.p_O, 0.0, 0.0;
  filter.point_covariance_.setZero();
  filter.point_covariance_.topLeftCorner<2, 2>() = fix.covariance;
  filter.point_covariance_.bottomRightCorner<2, 2>() =
      kCameraSpeedSigma_mps * kCameraSpeedSigma_mps * Eigen::Matrix2d::Identity();
  return filter;
}

void TrackFilter::Predict(double dt_s, const FilterSettings& settings) {
  age_s_ += dt_s;
  if (is_vehicle_) {
    PredictExtended(vehicle_, dt_s, settings.motion);
    return;
  }
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 2) = F(1, 3) = dt_s;
  point_ = (F * point_).eval();
  Eigen::Matrix4d P = F * point_covariance_ * F.transpose();
  const double q = kPointAccelPsd;
  for (int i = 0; i < 2; ++i) {
    P(i, i) += q * dt_s * dt_s * dt_s / 3.0;
    P(i, i + 2) += q * dt_s * dt_s / 2.0;
    P(i + 2, i) += q * dt_s * dt_s / 2.0;
    P(i + 2, i + 2) += q * dt_s;
  }
  point_covariance_ = 0.5 * (P + P.transpose());
}

std::optional<Likelihood> TrackFilter::Evaluate(const RadarLook& look, const RadarMeasurement& z,
                                                const FilterSettings& settings) const {
  if (is_vehicle_) {
    const auto model = LinearizeVehicle(vehicle_, AssumedExtent(vehicle_, settings), look, z);
    return model ? EvaluateExtended(*model, vehicle_) : std::nullopt;
  }
  const auto model = LinearizePoint(point_, look, z, settings.point_targets);
  return model ? EvaluateInnovation<4>(model->y, model->H, model->R, point_covariance_)
               : std::nullopt;
}

std::optional<Likelihood> TrackFilter::Evaluate(const CameraLook& look, const CameraMeasurement& z,
                                                const FilterSettings& settings) const {
  if (is_vehicle_) {
    // A radar track is measured against what the box says it is: an 11 m lorry's silhouette is no
    // outlier of a car's.
    ExtendedState named = vehicle_;
    if (object_class_ == ObjectClass::kUnknown && z.object_class != ObjectClass::kUnknown) {
      AssumeClass(object_class_, z.object_class, named);
    }
    const auto model = LinearizeVehicle(named, AssumedExtent(named, settings), look, z);
    return model ? EvaluateExtended(*model, named) : std::nullopt;
  }
  const auto model = LinearizePoint(point_, look, z, settings.point_targets);
  return model ? EvaluateInnovation<4>(model->y, model->H, model->R, point_covariance_)
               : std::nullopt;
}

template <class Look, class Measurement>
bool TrackFilter::UpdateVehicle(const Look& look, const Measurement& z,
                                const FilterSettings& settings) {
  auto model = LinearizeVehicle(vehicle_, AssumedExtent(vehicle_, settings), look, z);
  if (!model) return false;
  ExtendedState next = vehicle_;
  const unsigned frozen = Frozen(vehicle_, seen_from_);
  if (!UpdateExtended(*model, next, kLearnsSize<Measurement>, frozen)) return false;
  if (age_s_ < kYoung_s) {
    // Iterated EKF, one more round: linearise where the first update went, then apply the result to
    // the prediction.
    auto again = LinearizeVehicle(next, AssumedExtent(next, settings), look, z);
    if (again) {
      ExtendedState::Vector back = vehicle_.mean - next.mean;
      back[kYaw] = WrapAngle(back[kYaw]);
      again->y -= again->H * back.head<kStateSize>() + again->E * back.tail<2>();
      ExtendedState iterated = vehicle_;
      if (UpdateExtended(*again, iterated, kLearnsSize<Measurement>, frozen)) next = iterated;
    }
  }
  vehicle_ = next;
  return true;
}

bool TrackFilter::Update(const RadarLook& look, const RadarMeasurement& z,
                         const FilterSettings& settings) {
  seen_from_ = look.origin_O();
  if (is_vehicle_) {
    if (!UpdateVehicle(look, z, settings)) return false;
    if (settings.point_targets || z.visible_share < kSpanShare) return true;
    const auto span = LinearizeSpan(vehicle_, look.ego, look.radar, z);
    if (!span) return true;
    const auto likelihood = EvaluateExtended(*span, vehicle_);
    if (likelihood && likelihood->distance_squared < kSpanGate) {
      ExtendedState grown = vehicle_;
      if (UpdateExtended(*span, grown)) {
        // A span bounds the length from below. Lorries show their far end last, so that it must not
        // make their length certain.
        const bool is_long =
            object_class_ == ObjectClass::kTruck || object_class_ == ObjectClass::kBus;
        if (is_long) grown.covariance = vehicle_.covariance;
        vehicle_ = grown;
      }
    }
    return true;
  }
  const auto model = LinearizePoint(point_, look, z, settings.point_targets);
  if (!model || !JosephUpdate<4>(model->y, model->H, model->R, point_, point_covariance_)) {
    return false;
  }
  PromoteIfDirected(settings);
  return true;
}

bool TrackFilter::Update(const CameraLook& look, const CameraMeasurement& z,
                         const FilterSettings& settings) {
  seen_from_ = look.origin_O();
  if (is_vehicle_) return UpdateVehicle(look, z, settings);
  const auto model = LinearizePoint(point_, look, z, settings.point_targets);
  if (!model || !JosephUpdate<4>(model->y, model->H, model->R, point_, point_covariance_)) {
    return false;
  }
  PromoteIfDirected(settings);
  return true;
}

void TrackFilter::Lengthen(double length_m, double sigma_m) {
  if (is_vehicle_) v2vouch::Lengthen(length_m, sigma_m, seen_from_, vehicle_);
}

void TrackFilter::SetClass(ObjectClass object_class) {
  if (object_class == object_class_) return;
  if (is_vehicle_) {
    AssumeClass(object_class_, object_class, vehicle_);
    // Spans of a part made many a lorry a five-metre van: they bound its length from below only.
    const Extent size = ClassExtent(object_class);
    if (object_class == ObjectClass::kTruck || object_class == ObjectClass::kBus) {
      Lengthen(size.length_m, size.length_sigma_m);
    }
  }
  object_class_ = object_class;
}

bool TrackFilter::HasDirection(double max_sigma_rad) const {
  const Eigen::Vector2d v = point_.tail<2>();
  const double speed = v.norm();
  if (speed < kDirectedSpeed_mps) return false;
  const Eigen::Vector2d across(-v.y() / speed, v.x() / speed);
  const Eigen::Vector2d along = v / speed;
  const Eigen::Matrix2d P = point_covariance_.bottomRightCorner<2, 2>();
  const double across_sigma = std::sqrt(across.dot(P * across));
  const double along_sigma = std::sqrt(along.dot(P * along));
  return across_sigma < max_sigma_rad * speed && along_sigma < kDirectedSpeedShare * speed;
}

// Centre, direction and size from the point: centre = point - offset of the reflections, with the
// derivatives that tie the centre to direction and size.
ExtendedState TrackFilter::AsVehicle(bool has_direction, const FilterSettings& settings) const {
  const Extent size = ClassExtent(object_class_);
  const Eigen::Vector2d v = point_.tail<2>();
  const double yaw = has_direction ? std::atan2(v.y(), v.x()) : default_yaw_rad_;
  const Eigen::Vector2d forward(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d p_SQ = point_.head<2>() - seen_from_;

  // Offset in axes of O, with the sensor seen from the point instead of from the centre: both lie
  // on nearly the same line. The distance is stretched by half a width, where the centre is.
  const auto offset_O = [&](double yaw_rad, const Extent& extent) -> Eigen::Vector2d {
    if (settings.point_targets) return Eigen::Vector2d::Zero();
    const double range = std::max(p_SQ.norm(), 0.5);
    const Eigen::Vector2d p_OS = -p_SQ * (1.0 + 0.5 * extent.width_m / range);
    return Eigen::Rotation2D<double>(yaw_rad) * ReflectionOffset(p_OS, yaw_rad, extent);
  };
  ExtendedState out;
  const Eigen::Vector2d centre = point_.head<2>() - offset_O(yaw, size);
  const double speed = has_direction ? v.norm() : v.dot(forward);
  out.mean << centre, yaw, speed, 0.0, 0.0, size.length_m, size.width_m;

  // Inputs: point, velocity, yaw (where only assumed), length, width.
  Eigen::Matrix<double, ExtendedState::kSize, 7> J =
      Eigen::Matrix<double, ExtendedState::kSize, 7>::Zero();
  const double h = 1e-4;
  const Eigen::Vector2d by_yaw = (offset_O(yaw + h, size) - offset_O(yaw - h, size)) / (2.0 * h);
  Extent longer = size, wider = size;
  longer.length_m += h;
  wider.width_m += h;
  J.topLeftCorner<2, 2>().setIdentity();
  J.block<2, 1>(0, 5) = -(offset_O(yaw, longer) - offset_O(yaw, size)) / h;
  J.block<2, 1>(0, 6) = -(offset_O(yaw, wider) - offset_O(yaw, size)) / h;
  J.block<1, 2>(kSpeed, 2) = forward.transpose();
  J(ExtendedState::kLength, 5) = 1.0;
  J(ExtendedState::kWidth, 6) = 1.0;
  Eigen::Matrix<double, 7, 7> P = Eigen::Matrix<double, 7, 7>::Zero();
  P.topLeftCorner<4, 4>() = point_covariance_;
  if (has_direction) {
    const Eigen::RowVector2d yaw_by_v =
        Eigen::RowVector2d(-v.y(), v.x()) / std::max(v.squaredNorm(), 1e-6);
    J.block<1, 2>(kYaw, 2) = yaw_by_v;
    J.block<2, 2>(0, 2) = -by_yaw * yaw_by_v;
  } else {
    J(kYaw, 4) = 1.0;
    J.block<2, 1>(0, 4) = -by_yaw;
    P(4, 4) = kAssumedYawSigma_rad * kAssumedYawSigma_rad;
  }
  P(5, 5) = size.length_sigma_m * size.length_sigma_m;
  P(6, 6) = size.width_sigma_m * size.width_sigma_m;
  out.covariance = J * P * J.transpose();
  out.covariance(kYawRate, kYawRate) = kInitialYawRateSigma_radps * kInitialYawRateSigma_radps;
  out.covariance(kAccel, kAccel) = kInitialAccelSigma_mps2 * kInitialAccelSigma_mps2;
  return out;
}

void TrackFilter::PromoteIfDirected(const FilterSettings& settings) {
  if (!HasDirection(kDirectedSigma_rad)) return;
  vehicle_ = AsVehicle(true, settings);
  is_vehicle_ = true;
}

void TrackFilter::Show(const FilterSettings& settings, LocalTrack& track) const {
  const ExtendedState state =
      is_vehicle_ ? vehicle_ : AsVehicle(HasDirection(kShownSigma_rad), settings);
  track.state_O = state.kinematic();
  track.extent = state.extent();
}

Eigen::Vector2d TrackFilter::position_O() const {
  return is_vehicle_ ? Eigen::Vector2d(vehicle_.mean.head<2>()) : Eigen::Vector2d(point_.head<2>());
}

Eigen::Vector2d TrackFilter::velocity_O() const {
  if (!is_vehicle_) return point_.tail<2>();
  return vehicle_.mean[kSpeed] *
         Eigen::Vector2d(std::cos(vehicle_.mean[kYaw]), std::sin(vehicle_.mean[kYaw]));
}

Eigen::Matrix2d TrackFilter::position_covariance() const {
  return is_vehicle_ ? Eigen::Matrix2d(vehicle_.covariance.topLeftCorner<2, 2>())
                     : Eigen::Matrix2d(point_covariance_.topLeftCorner<2, 2>());
}

}  // namespace v2vouch
