// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "daemon/common/models/dual.h"

namespace v2vouch {

/// Where a box reflects: mean and scatter of one reflection in the box's own axes (x forward, y
/// left, from its centre) [m]. T is double or Dual.
template <class T>
struct Reflections {
  T along = T(0.0);
  T across = T(0.0);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
};

/// One edge of a field of view: points q with normal . (q - sensor) >= 0 are inside, box axes.
template <class T>
struct ViewEdge {
  T normal_x = T(0.0);
  T normal_y = T(0.0);
};

inline double ValueOf(double x) { return x; }
template <int N>
double ValueOf(const Dual<N>& x) {
  return x.value;
}

/// One box as a sensor sees it; see ReflectionOffset of measurement_model.h for the formula.
/// `ax`, `ay`: unit vector from the box's centre to the sensor in box axes, `range` the distance.
template <class T>
class ReflectingBox {
 public:
  ReflectingBox(const T& ax, const T& ay, const T& range, const T& length, const T& width)
      : sensor_x_(ax * range),
        sensor_y_(ay * range),
        half_length_(0.5 * length),
        half_width_(0.5 * width) {
    using std::sqrt;
    const T abs_x = sqrt(ax * ax + T(kBlur * kBlur));
    const T abs_y = sqrt(ay * ay + T(kBlur * kBlur));
    // Angle of a face: length x cosine / distance, with the sensor's height over the face's plane
    // and the distance to the face's middle.
    const T deep = half_length_ / range;
    const T wide = half_width_ / range;
    front_.weight = Positive(abs_x - deep) * width / (T(1.0) - 2.0 * (abs_x * deep) + deep * deep);
    side_.weight = Positive(abs_y - wide) * length / (T(1.0) - 2.0 * (abs_y * wide) + wide * wide);
    front_sign_ = ax / abs_x;
    side_sign_ = ay / abs_y;
  }

  /// Cuts off what lies beyond one edge of the field of view.
  void Cut(const ViewEdge<T>& edge) {
    // Points of the front are (sign L/2, t W/2), of the side (t L/2, sign W/2), t in [-1, 1].
    const T base = T(0.0) - edge.normal_x * sensor_x_ - edge.normal_y * sensor_y_;
    Cut(base + edge.normal_x * front_sign_ * half_length_, edge.normal_y * half_width_, front_);
    Cut(base + edge.normal_y * side_sign_ * half_width_, edge.normal_x * half_length_, side_);
  }

  /// nullopt where nothing is left.
  [[nodiscard]] std::optional<Reflections<T>> Reflect() const {
    const T front = front_.weight * 0.5 * (front_.high - front_.low);
    const T side = side_.weight * 0.5 * (side_.high - side_.low);
    const T sum = front + side;
    if (!(ValueOf(sum) > 0.0)) return std::nullopt;
    const T share = front / sum;
    const T front_x = front_sign_ * half_length_;
    const T front_y = 0.5 * (front_.low + front_.high) * half_width_;
    const T side_x = 0.5 * (side_.low + side_.high) * half_length_;
    const T side_y = side_sign_ * half_width_;
    Reflections<T> out;
    out.along = share * front_x + (T(1.0) - share) * side_x;
    out.across = share * front_y + (T(1.0) - share) * side_y;
    // Uniform along each face.
    const double s = ValueOf(share);
    const Eigen::Vector2d between(ValueOf(front_x) - ValueOf(side_x),
                                  ValueOf(front_y) - ValueOf(side_y));
    const double deep = ValueOf(half_length_) * (ValueOf(side_.high) - ValueOf(side_.low));
    const double wide = ValueOf(half_width_) * (ValueOf(front_.high) - ValueOf(front_.low));
    out.spread = s * (1.0 - s) * between * between.transpose();
    out.spread(0, 0) += (1.0 - s) * deep * deep / 12.0;
    out.spread(1, 1) += s * wide * wide / 12.0;
    return out;
  }

 private:
  // Smoothing of the faces' weights and of their signs, as sine of the aspect.
  static constexpr double kBlur = 0.01;

  struct Face {
    T weight = T(0.0);
    T low = T(-1.0);  // The part that is seen.
    T high = T(1.0);
  };

  static T Positive(const T& a) {
    using std::sqrt;
    return 0.5 * (a + sqrt(a * a + T(kBlur * kBlur)));
  }

  // Leaves of the face where base + slope t >= 0.
  static void Cut(const T& base, const T& slope, Face& face) {
    if (ValueOf(face.low) >= ValueOf(face.high)) return;
    const auto at = [&](const T& t) { return ValueOf(base) + ValueOf(slope) * ValueOf(t); };
    const bool keeps_low = at(face.low) >= 0.0;
    const bool keeps_high = at(face.high) >= 0.0;
    if (keeps_low && keeps_high) return;
    if (!keeps_low && !keeps_high) {
      face.high = face.low;
      return;
    }
    const T edge = (T(0.0) - base) / slope;
    (keeps_low ? face.high : face.low) = edge;
  }

  T sensor_x_, sensor_y_, half_length_, half_width_;
  T front_sign_, side_sign_;
  Face front_, side_;
};

}  // namespace v2vouch
