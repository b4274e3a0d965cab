// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/track_filter.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/candidates.h"

namespace v2vouch {
namespace {

// Heading sigma for becoming a vehicle, and for being shown as one.
constexpr double kDirectedSigma_rad = 0.15;
constexpr double kShownSigma_rad = 0.6;
// What drives slowly shows its direction late. It becomes a vehicle before it is passed, since only
// of a vehicle is it known how what shows of it slides from the tail to the flank.
constexpr double kLateSigma_rad = 0.3;
constexpr double kLongKnown_s = 2.0;
constexpr double kSoonPassed_m = 40.0;
// Sigma of the speed over the speed: five standard deviations from standing for good, three until
// the next list.
constexpr double kDirectedShare = 0.2;
constexpr double kShownShare = 0.35;
// What is hardly longer than wide loses nothing by a wrong direction.
constexpr double kShownSmallShare = 0.5;
constexpr double kSmall_m = 2.5;
// A direction that was only assumed.
constexpr double kAssumedYawSigma_rad = 0.7;
// Young tracks are linearised twice: range rate bends strongly over an uncertain heading.
constexpr double kYoung_s = 0.7;
// Lasting error of the reflection model, along the vehicle and in any direction.
constexpr double kAlongFloor_m = 0.06;
constexpr double kFloor_m = 0.1;
// Lasting errors of a centre that was put together from reflections and edges: which part of the
// body shows,
constexpr double kBody_m = 0.2;
// what stands and shows the same part for as long as it does,
constexpr double kStill_m = 0.5;
constexpr double kStill_mps = 1.0;
// and what no picture has named, so that nobody knows how far it goes on.
constexpr double kUnnamed_m = 0.4;
// The middle of a picture's box slides over the body while the line of sight turns, from the tail
// round a corner to the far end of the flank: so far per radian, 1 sigma.
constexpr double kSlide_m = 2.0;
// With Doppler as well, half as far, and only where the velocity is small: what drives past has a
// clear direction.
constexpr double kSlideWithDoppler_m = 1.0;
constexpr double kCreeping_mps = 4.0;
// A silhouette wider than this shows a side, unless a lorry's.
constexpr double kWidestCar_m = 3.2;

}  // namespace

TrackFilter TrackFilter::FromRadar(const RadarLook& look, const RadarMeasurement& z,
                                   const FilterSettings& settings) {
  TrackFilter filter;
  filter.point_ = PointFilter::FromRadar(look, z, settings.point_targets);
  filter.Note(z);
  filter.seen_from_ = look.origin_O();
  filter.default_yaw_rad_ = look.ego.X_OB.yaw_rad();
  return filter;
}

TrackFilter TrackFilter::FromCamera(const CameraLook& look, const CameraMeasurement& z,
                                    const Fix& fix) {
  TrackFilter filter;
  filter.point_ = PointFilter::FromCamera(fix);
  filter.seen_from_ = look.origin_O();
  filter.default_yaw_rad_ = look.ego.X_OB.yaw_rad();
  const double width_m =
      (z.azimuth_left_rad - z.azimuth_right_rad) * (fix.p_O - filter.seen_from_).norm();
  if (width_m > kWidestCar_m && !IsLong(z.object_class)) {
    filter.default_yaw_rad_ = WrapAngle(filter.default_yaw_rad_ + 0.5 * kPi);
  }
  return filter;
}

void TrackFilter::TakeStanding(const Fix& fix) {
  if (is_vehicle_) return;
  point_ = PointFilter::FromStanding(fix, seen_from_);
  if (doppler_ == Doppler::kUnseen) doppler_ = Doppler::kNone;
}

void TrackFilter::Predict(double dt_s, const FilterSettings& settings) {
  age_s_ += dt_s;
  if (is_vehicle_) {
    vehicle_.Predict(dt_s, settings);
  } else {
    point_.Predict(dt_s);
  }
}

template <class Look, class Measurement>
std::optional<Likelihood> TrackFilter::Evaluate(const Look& look, const Measurement& z,
                                                const FilterSettings& settings) const {
  return is_vehicle_ ? vehicle_.Evaluate(look, z, object_class_, settings)
                     : point_.Evaluate(look, z, settings.point_targets);
}

template <class Look, class Measurement>
bool TrackFilter::Update(const Look& look, const Measurement& z, const FilterSettings& settings) {
  seen_from_ = look.origin_O();
  ego_velocity_ = look.ego.X_OB.rotation() * Eigen::Vector2d(look.ego.speed_mps, 0.0);
  if (!is_vehicle_) {
    if (!point_.Update(look, z, settings.point_targets)) return false;
    Note(z);
    PromoteIfClear(settings);
    return true;
  }
  if (moves_in_pictures_) {
    Note(z);
    if (doppler_ == Doppler::kNone) return StandStill(look, z);
    moves_in_pictures_ = doppler_ == Doppler::kUnseen;
  }
  return vehicle_.Update(look, z, age_s_ < kYoung_s, settings);
}

void TrackFilter::Note(const RadarMeasurement& z) {
  if (doppler_ != Doppler::kMoving) doppler_ = z.is_static ? Doppler::kNone : Doppler::kMoving;
}

// The motion was the pictures' error: the first radar that sees it sees it standing.
bool TrackFilter::StandStill(const RadarLook& look, const RadarMeasurement& z) {
  point_ = PointFilter::FromStanding(ReflectionFixOf(look, z), seen_from_);
  is_vehicle_ = moves_in_pictures_ = false;
  return true;
}

// What never showed a radar any Doppler stands, however its reflections wander: across the line of
// sight nothing drives for long.
bool TrackFilter::HasDirection(const PointFilter& point, double max_sigma_rad,
                               double most_share) const {
  return doppler_ != Doppler::kNone && point.HasDirection(max_sigma_rad, most_share);
}

void TrackFilter::PromoteIfClear(const FilterSettings& settings) {
  // A lorry's point lies somewhere along it: AssumeClass knows how little that says.
  const ObjectClass first = IsLong(object_class_) ? ObjectClass::kUnknown : object_class_;
  const Extent size = ClassExtent(first);
  const PointFilter point = SlidingPoint(settings);
  const bool is_known_long = has_pictures_ && doppler_ == Doppler::kMoving &&
                             age_s_ > kLongKnown_s && point.velocity().norm() < kCreeping_mps &&
                             (point.position() - seen_from_).norm() < kSoonPassed_m;
  if (HasDirection(point, is_known_long ? kLateSigma_rad : kDirectedSigma_rad, kDirectedShare)) {
    vehicle_.StartMoving(point, size, seen_from_, settings);
    is_vehicle_ = true;
    moves_in_pictures_ = doppler_ == Doppler::kUnseen;
  } else if (point_.IsStanding()) {
    vehicle_.StartStanding(point_, default_yaw_rad_, size, seen_from_, settings);
    is_vehicle_ = true;
  }
  if (is_vehicle_ && first != object_class_) {
    vehicle_.AssumeClass(first, object_class_, seen_from_);
  }
}

void TrackFilter::Lengthen(double length_m, double sigma_m) {
  if (is_vehicle_) vehicle_.Lengthen(length_m, sigma_m, seen_from_);
}

void TrackFilter::SetClass(ObjectClass object_class) {
  if (object_class == object_class_) return;
  if (is_vehicle_ && !vehicle_.is_size_open()) {
    vehicle_.AssumeClass(object_class_, object_class, seen_from_);
  }
  object_class_ = object_class;
}

// The point with the doubt that passing it leaves in the velocity.
PointFilter TrackFilter::SlidingPoint(const FilterSettings& settings) const {
  const bool drives = doppler_ == Doppler::kMoving;
  const bool is_clear = drives && (!has_pictures_ || point_.velocity().norm() > kCreeping_mps);
  if (settings.point_targets || is_clear) return point_;
  const Eigen::Vector2d line = point_.position() - seen_from_;
  const Eigen::Vector2d passing = point_.velocity() - ego_velocity_;
  const double range_m = std::max(line.norm(), 1.0);
  const double turn_radps =
      std::abs(line.x() * passing.y() - line.y() * passing.x()) / (range_m * range_m);
  return point_.Doubted((drives ? kSlideWithDoppler_m : kSlide_m) * turn_radps);
}

ExtendedState TrackFilter::ShowPoint(const FilterSettings& settings) const {
  const Extent size = ClassExtent(object_class_);
  const double share = size.length_m < kSmall_m ? kShownSmallShare : kShownShare;
  const PointFilter point = SlidingPoint(settings);
  if (HasDirection(point, kShownSigma_rad, share)) {
    return VehicleAt(point, 0.0, 0.0, size, seen_from_, settings);
  }
  ExtendedState state =
      VehicleAt(point_, default_yaw_rad_, kAssumedYawSigma_rad, size, seen_from_, settings);
  // Along the assumed direction the speed may be known well, and it says nothing of the rest.
  const Eigen::Vector2d forward(std::cos(default_yaw_rad_), std::sin(default_yaw_rad_));
  const Eigen::Vector2d across = point_.velocity() - point_.velocity().dot(forward) * forward;
  const double sigma_mps = LargestSigma(point_.covariance().bottomRightCorner<2, 2>());
  double& variance = state.covariance(kSpeed, kSpeed);
  variance = std::max(variance, sigma_mps * sigma_mps + across.squaredNorm());
  return state;
}

// What is the same in look after look does not average out, and the filter cannot see it.
double TrackFilter::LastingVariance(const ExtendedState& state) const {
  if (is_measured_whole_) return 0.0;
  const double ratio = state.mean[kSpeed] / kStill_mps;
  double variance = kBody_m * kBody_m + kStill_m * kStill_m / (1.0 + ratio * ratio);
  if (object_class_ == ObjectClass::kUnknown) variance += kUnnamed_m * kUnnamed_m;
  return variance;
}

void TrackFilter::Show(const FilterSettings& settings, LocalTrack& track) const {
  const ExtendedState state = is_vehicle_ ? vehicle_.Show() : ShowPoint(settings);
  track.state_O = state.kinematic();
  if (!settings.point_targets) {
    // Where on its body a vehicle reflects is much the same from scan to scan.
    const Eigen::Vector2d forward(std::cos(state.mean[kYaw]), std::sin(state.mean[kYaw]));
    track.state_O.covariance.topLeftCorner<2, 2>() +=
        kAlongFloor_m * kAlongFloor_m * forward * forward.transpose() +
        kFloor_m * kFloor_m * Eigen::Matrix2d::Identity();
    track.lasting_variance_m2 = LastingVariance(state);
  }
  track.extent = state.extent();
  const double length_variance = state.covariance(ExtendedState::kLength, ExtendedState::kLength);
  track.centre_by_length_O =
      length_variance > 0.0
          ? Eigen::Vector2d(state.covariance.block<2, 1>(0, ExtendedState::kLength) /
                            length_variance)
          : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

Eigen::Vector2d TrackFilter::position_O() const {
  return is_vehicle_ ? Eigen::Vector2d(vehicle_.best().mean.head<2>()) : point_.position();
}

Eigen::Vector2d TrackFilter::velocity_O() const {
  if (!is_vehicle_) return point_.velocity();
  const auto& mean = vehicle_.best().mean;
  return mean[kSpeed] * Eigen::Vector2d(std::cos(mean[kYaw]), std::sin(mean[kYaw]));
}

Eigen::Matrix2d TrackFilter::position_covariance() const {
  return is_vehicle_ ? vehicle_.position_covariance()
                     : Eigen::Matrix2d(point_.covariance().topLeftCorner<2, 2>());
}

template std::optional<Likelihood> TrackFilter::Evaluate(const RadarLook&, const RadarMeasurement&,
                                                         const FilterSettings&) const;
template std::optional<Likelihood> TrackFilter::Evaluate(const CameraLook&,
                                                         const CameraMeasurement&,
                                                         const FilterSettings&) const;
template bool TrackFilter::Update(const RadarLook&, const RadarMeasurement&, const FilterSettings&);
template bool TrackFilter::Update(const CameraLook&, const CameraMeasurement&,
                                  const FilterSettings&);

}  // namespace v2vouch
