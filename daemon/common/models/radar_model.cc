// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/dual.h"
#include "daemon/common/models/measurement_model.h"
#include "daemon/common/models/radar_outline.h"
#include "daemon/common/models/reflections.h"

namespace v2vouch {
namespace {

constexpr double kMinRange_m = 0.1;  // Nearer, azimuth has no meaning.
// Extents below this are a point.
constexpr double kPoint_m = 1e-3;
// Share of the reflections' spread that more reflections do not remove: scatterers sit where the
// body puts them (wheels, corners, plate) and stay there from scan to scan.
constexpr double kLastingSpread = 0.04;
// Vehicles longer than this are measured at the end they turn to the radar, from this far before
// it.
constexpr double kLong_m = 7.0;
constexpr double kEndGap_m = 2.0;
constexpr double kEndSigma_m = 0.25;
// Yaw rate that an estimate of it may miss while a vehicle begins to turn.
constexpr double kYawRateDoubt_radps = 0.15;

// A sensor that tracks by itself reports some point of the vehicle, a corner, a face or the centre,
// and now and then another: on average half way to the near outline, off by this share of half the
// vehicle's size. It stays for a while; the rest is new in every report.
constexpr double kObjectMean = 0.5;
constexpr double kObjectLasting = 0.5;
constexpr double kObjectWhite = 1.2;

bool IsPoint(double length_m, double width_m) { return length_m < kPoint_m || width_m < kPoint_m; }

using D = Dual<kStateSize + 2>;

// The edges of a radar's field of view, where the box straddles them, in the box's axes.
// Returns whether there was one.
bool CutByView(const RadarConfig& radar, double sensor_yaw_rad, const D& yaw, const D& px,
               const D& py, const Extent& extent, ReflectingBox<D>& box) {
  if (radar.half_fov_rad >= 0.5 * kPi) return false;
  const double middle = std::atan2(py.value, px.value);
  const double range = std::hypot(px.value, py.value);
  const double half = std::atan2(0.5 * std::hypot(extent.length_m, extent.width_m), range);
  const double off_axis = WrapAngle(middle - sensor_yaw_rad);
  bool is_near_an_edge = false;
  for (const double side : {1.0, -1.0}) {
    if (side * off_axis + half < radar.half_fov_rad) continue;
    // Inside of the left edge is to its right, and the other way round.
    const D edge = D(sensor_yaw_rad + side * radar.half_fov_rad) - yaw;
    box.Cut({side * sin(edge), -side * cos(edge)});
    is_near_an_edge = true;
  }
  return is_near_an_edge;
}

// Distance to the front or rear of a long vehicle, where the radar stands before it: the mean of
// the reflections along ten metres says little about where the vehicle is, the nearest one much.
// nullopt for short vehicles and beside the flank.
std::optional<D> NearEnd(const D& px, const D& py, const D& c, const D& s, const Extent& extent) {
  if (extent.length_m < kLong_m) return std::nullopt;
  const D sx = -(c * px + s * py);  // The radar in vehicle axes.
  const D sy = s * px - c * py;
  const double ahead = sx.value >= 0.0 ? 1.0 : -1.0;
  const D gap = ahead * sx - 0.5 * D::Variable(extent.length_m, kStateSize);
  if (gap.value < kEndGap_m) return std::nullopt;
  const double aside = sy.value >= 0.0 ? 1.0 : -1.0;
  const D past = aside * sy - 0.5 * D::Variable(extent.width_m, kStateSize + 1);
  return past.value > 0.0 ? sqrt(gap * gap + past * past) : gap;
}

// Where the vehicle is from the antenna, axes of O, and its heading.
struct Bearing {
  D px, py, distance;
  D yaw, c, s;
};

// Mean of the reflections from the centre, axes of O, and their spread.
struct Mean {
  D ox{0.0}, oy{0.0};
  Eigen::Matrix2d spread_O = Eigen::Matrix2d::Zero();
  bool is_cut = false;  // By an edge of the field of view, which the mean allows for.
};

Mean MeanOfReflections(const Bearing& b, const RadarConfig& radar, double sensor_yaw_rad,
                       const Extent& extent) {
  Mean mean;
  const D length = D::Variable(extent.length_m, kStateSize);
  const D width = D::Variable(extent.width_m, kStateSize + 1);
  const D ax = -(b.c * b.px + b.s * b.py) / b.distance;
  const D ay = (b.s * b.px - b.c * b.py) / b.distance;
  ReflectingBox<D> box(ax, ay, b.distance, length, width);
  const auto whole = box.Reflect();
  const bool is_near_an_edge = CutByView(radar, sensor_yaw_rad, b.yaw, b.px, b.py, extent, box);
  const auto cut = is_near_an_edge ? box.Reflect() : whole;
  mean.is_cut = cut && cut->spread != whole->spread;
  const Reflections<D>& seen = cut ? *cut : *whole;
  mean.ox = b.c * seen.along - b.s * seen.across;
  mean.oy = b.s * seen.along + b.c * seen.across;
  Eigen::Matrix2d R_OT;
  R_OT << b.c.value, -b.s.value, b.s.value, b.c.value;
  mean.spread_O = R_OT * seen.spread * R_OT.transpose();
  return mean;
}

struct Prediction {
  D range, azimuth_O, range_rate;
  std::optional<D> near_end;
};

// Innovation and Jacobians; without noise.
Linearized Innovate(const Prediction& predicted, double sensor_yaw_rad, const RadarConfig& radar,
                    const RadarMeasurement& measurement) {
  const auto& near_end = predicted.near_end;
  Linearized out;
  out.y.resize(3);
  out.H.resize(3, Eigen::NoChange);
  out.E.resize(3, Eigen::NoChange);
  const D* const rows[3] = {near_end ? &*near_end : &predicted.range, &predicted.azimuth_O,
                            &predicted.range_rate};
  for (int i = 0; i < 3; ++i) {
    out.H.row(i) = rows[i]->gradient.head<kStateSize>();
    out.E.row(i) = rows[i]->gradient.tail<2>();
  }
  out.y[0] = measurement.range_m - predicted.range.value;
  if (near_end) {
    // The nearest of a few reflections lies before the face by what noise does to it.
    const double few = 0.5 * (1.0 + std::max(measurement.returns, 1));
    const double early_m = radar.range_sigma_m * std::sqrt(0.6 * std::log(few));
    out.y[0] = measurement.near_range_m + early_m - near_end->value;
  }
  out.y[1] = WrapAngle(measurement.azimuth_rad + sensor_yaw_rad - predicted.azimuth_O.value);
  out.y[2] = measurement.range_rate_mps - predicted.range_rate.value;
  return out;
}

// The reflections' mean from the antenna.
struct Line {
  Eigen::Vector2d along, across;  // Unit vectors.
  double range_m;
  Eigen::Vector2d velocity_O;
  double yaw_rate_radps;
};

// What the reflections' scatter over the body adds to the measurement's own covariance.
void AddScatter(const Mean& reflections, const Line& line, const RadarConfig& radar,
                const RadarMeasurement& measurement, Eigen::Matrix3d& R) {
  const Eigen::Vector2d& across = line.across;
  const Eigen::Matrix2d& spread_O = reflections.spread_O;
  Eigen::Matrix<double, 3, 2> G;  // d(range, azimuth, range rate)/d(reflection point)
  G.row(0) = line.along.transpose();
  G.row(1) = across.transpose() / line.range_m;
  // A point to the left of the line moves towards or away by the vehicle's yaw rate, and the line
  // to it takes another share of the velocity: a passing car's nose comes while its tail goes.
  const double passing_mps = across.dot(line.velocity_O);
  G.row(2) = (passing_mps / line.range_m - line.yaw_rate_radps) * across.transpose();
  const Eigen::Matrix3d spread = G * spread_O * G.transpose();
  const double n = std::max(measurement.returns, 1);
  const Eigen::Array3d sensor(radar.range_sigma_m, radar.azimuth_sigma_rad,
                              radar.range_rate_sigma_mps);
  // What a sample mean of n reflections scatters by. The measurement's own covariance may hold
  // the scatter already, as far as the sample shows it: the larger counts.
  Eigen::Matrix3d mean = spread / n;
  const Eigen::Array3d given = measurement.covariance.diagonal().array();
  mean.diagonal().array() += given.min(sensor.square() / n);
  R.diagonal().setZero();
  R += mean + kLastingSpread * spread;
  // With a part unseen the rest's mean is displaced.
  const double unseen =
      reflections.is_cut ? 0.0 : std::clamp(1.0 - measurement.visible_share, 0.0, 1.0);
  R += kUnseenLooks * unseen * unseen * spread;
  // The yaw rate is not known that well: off-centre points move by what is wrong with it.
  R(2, 2) += kYawRateDoubt_radps * kYawRateDoubt_radps * across.dot(spread_O * across) / n;
  const Eigen::Array3d missing = given - mean.diagonal().array();
  R.diagonal().array() += missing.max(0.0);
}

// Which point of the vehicle an object's place is: a lasting offset and noise.
void AddReference(const Eigen::Vector2d& along, const Bearing& b, const Extent& extent,
                  double range_m, Eigen::Matrix3d& R, Linearized& out) {
  const double cosine = along.x() * b.c.value + along.y() * b.s.value;
  const double sine = along.x() * b.s.value - along.y() * b.c.value;
  const double radial_m = 0.5 * std::hypot(cosine * extent.length_m, sine * extent.width_m);
  const double across_m = 0.5 * std::hypot(sine * extent.length_m, cosine * extent.width_m);
  R(0, 0) += std::pow(kObjectWhite * radial_m, 2);
  R(1, 1) += std::pow(kObjectWhite * across_m / range_m, 2);
  out.O.setZero(3, 2);
  out.O(0, 0) = kObjectLasting * radial_m / kDepthOffsetSigma_m;
  out.O(1, 1) = kObjectLasting * across_m / (range_m * kAsideOffsetSigma);
}

}  // namespace

Eigen::Vector2d AntennaVelocity_B(const EgoState& ego, const RadarConfig& radar) {
  return {ego.speed_mps - ego.yaw_rate_radps * radar.y_m, ego.yaw_rate_radps * radar.x_m};
}

Eigen::Vector2d EgoMotionVariances(const EgoState& ego, const RadarConfig& radar,
                                   const Eigen::Vector2d& line_B) {
  const double lever = line_B.y() * radar.x_m - line_B.x() * radar.y_m;
  return {std::pow(line_B.x() * ego.speed_sigma_mps, 2),
          std::pow(lever * ego.yaw_rate_sigma_radps, 2)};
}

Eigen::Vector2d ReflectionOffset(const Eigen::Vector2d& p_OS, double yaw_rad,
                                 const Extent& extent) {
  return ReflectionOffset(p_OS, Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad)), extent);
}

Eigen::Vector2d ReflectionOffset(const Eigen::Vector2d& p_OS, const Eigen::Vector2d& forward_O,
                                 const Extent& extent) {
  const double range_m = p_OS.norm();
  if (range_m < kMinRange_m || IsPoint(extent.length_m, extent.width_m)) {
    return Eigen::Vector2d::Zero();
  }
  const double c = forward_O.x();
  const double s = forward_O.y();
  const double ax = (c * p_OS.x() + s * p_OS.y()) / range_m;
  const double ay = (c * p_OS.y() - s * p_OS.x()) / range_m;
  const ReflectingBox<double> box(ax, ay, range_m, extent.length_m, extent.width_m);
  const auto seen = box.Reflect();
  return seen ? Eigen::Vector2d(seen->along, seen->across) : Eigen::Vector2d::Zero();
}

std::optional<Linearized> LinearizeRadar(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& measurement) {
  if (measurement.outline_count > 0 && !IsPoint(extent.length_m, extent.width_m)) {
    if (auto outline = LinearizeOutline(x, extent, ego, radar, measurement)) return outline;
  }
  const Pose<Odometry, Radar> X_OR =
      ego.X_OB * Pose<Body, Radar>(radar.x_m, radar.y_m, radar.yaw_rad);
  const Eigen::Matrix2d R_OB = ego.X_OB.rotation();
  const Eigen::Vector2d v_R_O = R_OB * AntennaVelocity_B(ego, radar);

  const D px = D::Variable(x[kX] - X_OR.x_m(), kX);
  const D py = D::Variable(x[kY] - X_OR.y_m(), kY);
  const D yaw = D::Variable(x[kYaw], kYaw);
  const D speed = D::Variable(x[kSpeed], kSpeed);
  const D yaw_rate = D::Variable(x[kYawRate], kYawRate);
  const D distance = sqrt(px * px + py * py);
  if (!(distance.value > kMinRange_m)) return std::nullopt;
  const Bearing bearing{px, py, distance, yaw, cos(yaw), sin(yaw)};

  const bool is_point = IsPoint(extent.length_m, extent.width_m);
  const Mean mean = is_point ? Mean{} : MeanOfReflections(bearing, radar, X_OR.yaw_rad(), extent);
  const double share = measurement.is_object ? kObjectMean : 1.0;
  const D qx = px + share * mean.ox;
  const D qy = py + share * mean.oy;
  const D range = sqrt(qx * qx + qy * qy);
  if (!(range.value > kMinRange_m)) return std::nullopt;
  // Every point of a turning vehicle moves with its centre plus yaw rate x offset.
  const D vx = speed * bearing.c - yaw_rate * mean.oy - D(v_R_O.x());
  const D vy = speed * bearing.s + yaw_rate * mean.ox - D(v_R_O.y());
  const D range_rate = (qx * vx + qy * vy) / range;
  const auto near_end =
      measurement.is_object ? std::nullopt : NearEnd(px, py, bearing.c, bearing.s, extent);
  Linearized out =
      Innovate({range, atan2(qy, qx), range_rate, near_end}, X_OR.yaw_rad(), radar, measurement);
  Eigen::Matrix3d R = measurement.covariance;
  const Eigen::Vector2d along(qx.value / range.value, qy.value / range.value);
  if (!is_point && measurement.is_object) {
    AddReference(along, bearing, extent, range.value, R, out);
  } else if (!is_point) {
    const Line line{along, {-along.y(), along.x()}, range.value, {vx.value, vy.value}, x[kYawRate]};
    AddScatter(mean, line, radar, measurement, R);
    if (near_end) {
      // It has no part in the scatter of the others.
      R.row(0).setZero();
      R.col(0).setZero();
      R(0, 0) = radar.range_sigma_m * radar.range_sigma_m + kEndSigma_m * kEndSigma_m;
    }
  }
  R(2, 2) += EgoMotionVariances(ego, radar, R_OB.transpose() * along).sum();
  out.R = R;
  const Eigen::Vector2d extent_variance(extent.length_sigma_m * extent.length_sigma_m,
                                        extent.width_sigma_m * extent.width_sigma_m);
  out.R += out.E * extent_variance.asDiagonal() * out.E.transpose();
  return out;
}

}  // namespace v2vouch
