// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "daemon/base/angle.h"
#include "daemon/models/dual.h"
#include "daemon/models/measurement_model.h"

namespace v2vouch {
namespace {

constexpr double kMinRange_m = 0.1;
// Smoothing of the faces' weights and of their signs, as sine of the aspect.
constexpr double kFaceBlur = 0.01;
// Extents below this are a point.
constexpr double kPoint_m = 1e-3;
// Share of the reflections' spread that more reflections do not remove: scatterers sit where the
// body puts them (wheels, corners, plate) and stay there from scan to scan.
constexpr double kLastingSpread = 0.04;
// What is not seen shifts the mean of the rest, by up to half of its own length: for one face
// (1 - s)^2 x spread. The same part stays unseen from scan to scan: so many looks count as one.
constexpr double kUnseenLooks = 8.0;
// Yaw rate that an estimate of it may miss while a vehicle begins to turn.
constexpr double kYawRateDoubt_radps = 0.15;

bool IsPoint(double length_m, double width_m) { return length_m < kPoint_m || width_m < kPoint_m; }

template <class T>
T Positive(const T& a) {
  using std::sqrt;
  return 0.5 * (a + sqrt(a * a + T(kFaceBlur * kFaceBlur)));
}

// What the sensor sees of the box: weights of the two faces turned to it and their signs.
template <class T>
struct Faces {
  T front;       ///< Share of front or rear; the rest is the side.
  T front_sign;  ///< +1 front, -1 rear.
  T side_sign;   ///< +1 left, -1 right.
};

// `ax`, `ay`: unit vector from the vehicle to the sensor in vehicle axes.
template <class T>
Faces<T> VisibleFaces(const T& ax, const T& ay, const T& range, const T& length, const T& width) {
  using std::sqrt;
  const T abs_x = sqrt(ax * ax + T(kFaceBlur * kFaceBlur));
  const T abs_y = sqrt(ay * ay + T(kFaceBlur * kFaceBlur));
  // Angle of a face: length x cosine / distance, with the sensor's height over the face's plane and
  // the distance to the face's middle.
  const T deep = 0.5 * length / range;
  const T wide = 0.5 * width / range;
  const T front = Positive<T>(abs_x - deep) * width / (T(1.0) - 2.0 * (abs_x * deep) + deep * deep);
  const T side = Positive<T>(abs_y - wide) * length / (T(1.0) - 2.0 * (abs_y * wide) + wide * wide);
  return {front / (front + side), ax / abs_x, ay / abs_y};
}

// Mean of the reflections about the centre, vehicle axes.
template <class T>
void MeanReflection(const Faces<T>& faces, const T& length, const T& width, T& along, T& across) {
  along = 0.5 * (faces.front * faces.front_sign * length);
  across = 0.5 * ((T(1.0) - faces.front) * faces.side_sign * width);
}

// Covariance of one reflection about the mean, vehicle axes: uniform along each visible face.
Eigen::Matrix2d ReflectionSpread(const Faces<double>& faces, double length_m, double width_m) {
  const double front = faces.front;
  const double side = 1.0 - front;
  const Eigen::Vector2d on_front(0.5 * faces.front_sign * length_m, 0.0);
  const Eigen::Vector2d on_side(0.0, 0.5 * faces.side_sign * width_m);
  const Eigen::Vector2d between = on_front - on_side;
  Eigen::Matrix2d spread = front * side * between * between.transpose();
  spread(0, 0) += side * length_m * length_m / 12.0;
  spread(1, 1) += front * width_m * width_m / 12.0;
  return spread;
}

}  // namespace

Eigen::Vector2d ReflectionOffset(const Eigen::Vector2d& p_OS, double yaw_rad,
                                 const Extent& extent) {
  const double range_m = p_OS.norm();
  if (range_m < kMinRange_m || IsPoint(extent.length_m, extent.width_m)) {
    return Eigen::Vector2d::Zero();
  }
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  const double ax = (c * p_OS.x() + s * p_OS.y()) / range_m;
  const double ay = (c * p_OS.y() - s * p_OS.x()) / range_m;
  Eigen::Vector2d offset;
  MeanReflection(VisibleFaces(ax, ay, range_m, extent.length_m, extent.width_m), extent.length_m,
                 extent.width_m, offset.x(), offset.y());
  return offset;
}

std::optional<Linearized> LinearizeRadar(const StateVector& x, const Extent& extent,
                                         const EgoState& ego, const RadarConfig& radar,
                                         const RadarMeasurement& measurement) {
  using D = Dual<kStateSize + 2>;
  const Pose<Odometry, Radar> X_OR =
      ego.X_OB * Pose<Body, Radar>(radar.x_m, radar.y_m, radar.yaw_rad);
  // Velocity of the antenna: rear axle plus yaw rate x lever arm.
  const Eigen::Vector2d v_R_O =
      ego.X_OB.rotation() * Eigen::Vector2d(ego.speed_mps - ego.yaw_rate_radps * radar.y_m,
                                            ego.yaw_rate_radps * radar.x_m);

  const D px = D::Variable(x[kX] - X_OR.x_m(), kX);
  const D py = D::Variable(x[kY] - X_OR.y_m(), kY);
  const D yaw = D::Variable(x[kYaw], kYaw);
  const D speed = D::Variable(x[kSpeed], kSpeed);
  const D yaw_rate = D::Variable(x[kYawRate], kYawRate);
  const D distance = sqrt(px * px + py * py);
  if (!(distance.value > kMinRange_m)) return std::nullopt;
  const D c = cos(yaw);
  const D s = sin(yaw);

  D ox(0.0), oy(0.0);  // Offset of the reflections' mean from the centre, axes of O.
  Eigen::Matrix2d spread_O = Eigen::Matrix2d::Zero();
  const bool is_point = IsPoint(extent.length_m, extent.width_m);
  if (!is_point) {
    const D length = D::Variable(extent.length_m, kStateSize);
    const D width = D::Variable(extent.width_m, kStateSize + 1);
    const D ax = -(c * px + s * py) / distance;
    const D ay = (s * px - c * py) / distance;
    const Faces<D> faces = VisibleFaces(ax, ay, distance, length, width);
    D along, across;
    MeanReflection(faces, length, width, along, across);
    ox = c * along - s * across;
    oy = s * along + c * across;
    const Faces<double> seen{faces.front.value, faces.front_sign.value, faces.side_sign.value};
    Eigen::Matrix2d R_OT;
    R_OT << c.value, -s.value, s.value, c.value;
    spread_O = R_OT * ReflectionSpread(seen, extent.length_m, extent.width_m) * R_OT.transpose();
  }
  const D qx = px + ox;
  const D qy = py + oy;
  const D range = sqrt(qx * qx + qy * qy);
  if (!(range.value > kMinRange_m)) return std::nullopt;
  // Every point of a turning vehicle moves with its centre plus yaw rate x offset.
  const D vx = speed * c - yaw_rate * oy - D(v_R_O.x());
  const D vy = speed * s + yaw_rate * ox - D(v_R_O.y());
  const D range_rate = (qx * vx + qy * vy) / range;
  const D azimuth_O = atan2(qy, qx);

  Linearized out;
  out.y.resize(3);
  out.H.resize(3, Eigen::NoChange);
  out.E.resize(3, Eigen::NoChange);
  const D* const rows[3] = {&range, &azimuth_O, &range_rate};
  for (int i = 0; i < 3; ++i) {
    out.H.row(i) = rows[i]->gradient.head<kStateSize>();
    out.E.row(i) = rows[i]->gradient.tail<2>();
  }
  out.y[0] = measurement.range_m - range.value;
  out.y[1] = WrapAngle(measurement.azimuth_rad + X_OR.yaw_rad() - azimuth_O.value);
  out.y[2] = measurement.range_rate_mps - range_rate.value;

  Eigen::Matrix3d R = measurement.covariance;
  const Eigen::Vector2d line(qx.value / range.value, qy.value / range.value);
  const Eigen::Vector2d across(-line.y(), line.x());
  if (!is_point) {
    Eigen::Matrix<double, 3, 2> G;  // d(range, azimuth, range rate)/d(reflection point)
    G.row(0) = line.transpose();
    G.row(1) = across.transpose() / range.value;
    // A point to the left of the line moves towards or away by the vehicle's yaw rate, and the line
    // to it takes another share of the velocity: a passing car's nose comes while its tail goes.
    const double passing_mps = across.dot(Eigen::Vector2d(vx.value, vy.value));
    G.row(2) = (passing_mps / range.value - x[kYawRate]) * across.transpose();
    const Eigen::Matrix3d spread = G * spread_O * G.transpose();
    const double n = std::max(measurement.returns, 1);
    const Eigen::Array3d sensor(radar.range_sigma_m, radar.azimuth_sigma_rad,
                                radar.range_rate_sigma_mps);
    // What a sample mean of n reflections scatters by. The measurement's own covariance may hold
    // the scatter already, as far as the sample shows it: the larger counts. A sensor that tracks
    // by itself has averaged already.
    Eigen::Matrix3d mean = measurement.is_object ? Eigen::Matrix3d(spread * kLastingSpread)
                                                 : Eigen::Matrix3d(spread / n);
    const Eigen::Array3d given = measurement.covariance.diagonal().array();
    mean.diagonal().array() += given.min(sensor.square() / n);
    R.diagonal().setZero();
    R += mean + kLastingSpread * spread;
    // With a part unseen the rest's mean is displaced.
    const double unseen = std::clamp(1.0 - measurement.visible_share, 0.0, 1.0);
    R += kUnseenLooks * unseen * unseen * spread;
    // The yaw rate is not known that well: off-centre points move by what is wrong with it.
    R(2, 2) += kYawRateDoubt_radps * kYawRateDoubt_radps * across.dot(spread_O * across) / n;
    const Eigen::Array3d missing = given - mean.diagonal().array();
    R.diagonal().array() += missing.max(0.0);
  }
  // The ego's own motion is measured too: its noise reaches every range rate.
  const Eigen::Vector2d line_B = ego.X_OB.rotation().transpose() * line;
  const double lever = line_B.y() * radar.x_m - line_B.x() * radar.y_m;
  R(2, 2) +=
      std::pow(line_B.x() * ego.speed_sigma_mps, 2) + std::pow(lever * ego.yaw_rate_sigma_radps, 2);
  out.R = R;
  const Eigen::Vector2d extent_variance(extent.length_sigma_m * extent.length_sigma_m,
                                        extent.width_sigma_m * extent.width_sigma_m);
  out.R += out.E * extent_variance.asDiagonal() * out.E.transpose();
  return out;
}

}  // namespace v2vouch
