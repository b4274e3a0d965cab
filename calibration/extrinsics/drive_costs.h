// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/sized_cost_function.h>

#include <cmath>

#include "calibration/extrinsics/camera_projection.h"
#include "calibration/extrinsics/mounting_parameters.h"
#include "calibration/extrinsics/static_doppler.h"
#include "calibration/extrinsics/target_windows.h"

/// The equations of DriveProblem as Ceres cost functions, one scalar residual each.
namespace v2vouch {

/// Parameters: radar x, y, yaw | v, omega | ego.
class DopplerCost final : public ceres::SizedCostFunction<1, MountingParameters::kPerRadar, 2,
                                                          MountingParameters::kEgo> {
 public:
  explicit DopplerCost(const DopplerResidual& residual) : residual_(residual) {}
  bool Evaluate(double const* const* at, double* out, double** jacobians) const override {
    double* const d_radar = jacobians != nullptr ? jacobians[0] : nullptr;
    double* const d_motion = jacobians != nullptr ? jacobians[1] : nullptr;
    double* const d_ego = jacobians != nullptr ? jacobians[2] : nullptr;
    double d_slip = 0.0;
    out[0] = residual_(at[0], at[1], at[2][MountingParameters::kSlip], d_radar, d_motion, &d_slip);
    if (d_ego != nullptr) {
      std::fill(d_ego, d_ego + MountingParameters::kEgo, 0.0);
      d_ego[MountingParameters::kSlip] = d_slip;
    }
    return true;
  }

 private:
  DopplerResidual residual_;
};

/// The four measurements of the ego's own motion. Parameters: v, omega | ego.
struct SpeedCost {
  double speed_mps, sigma_mps;
  template <class T>
  bool operator()(const T* motion, const T* ego, T* out) const {
    out[0] = (T(speed_mps) - ego[MountingParameters::kSpeedScale] *
                                 (motion[0] - motion[1] * ego[MountingParameters::kOdometerY])) /
             T(sigma_mps);
    return true;
  }
};

struct YawRateCost {
  double yaw_rate_radps, sigma_radps;
  template <class T>
  bool operator()(const T* motion, const T* ego, T* out) const {
    out[0] =
        (T(yaw_rate_radps) - motion[1] - ego[MountingParameters::kYawRateBias]) / T(sigma_radps);
    return true;
  }
};

/// GNSS velocity, turned into the body by GNSS heading; `across`: the component to the left.
struct GnssVelocityCost {
  double velocity_e, velocity_n, yaw_rad;
  double dt_s, accel_mps2, yaw_accel_radps2;
  double sigma_mps;
  bool across;
  template <class T>
  bool operator()(const T* motion, const T* ego, T* out) const {
    using std::cos;
    using std::sin;
    const T v = motion[0] + T(dt_s * accel_mps2);
    const T omega = motion[1] + T(dt_s * yaw_accel_radps2);
    const T yaw = T(yaw_rad) - ego[MountingParameters::kHeadingBias];
    if (across) {
      const T left = T(velocity_n) * cos(yaw) - T(velocity_e) * sin(yaw);
      out[0] = (left - omega * (ego[MountingParameters::kAntennaX] -
                                ego[MountingParameters::kSlip] * v * v)) /
               T(sigma_mps);
    } else {
      const T ahead = T(velocity_e) * cos(yaw) + T(velocity_n) * sin(yaw);
      out[0] = (ahead - (v - omega * ego[MountingParameters::kAntennaY])) / T(sigma_mps);
    }
    return true;
  }
};

/// Heading against the integrated gyro, whose drift is linear between knots. Parameters: two knots.
struct HeadingDriftCost {
  double drift_rad, sigma_rad, share;
  template <class T>
  bool operator()(const T* from, const T* to, T* out) const {
    out[0] = (T(drift_rad) - T(1.0 - share) * *from - T(share) * *to) / T(sigma_rad);
    return true;
  }
};

/// The drift from one knot to the next: heading falls behind the gyro by its bias, and walks at
/// random with its white noise. Parameters: two knots | ego.
struct GyroDriftCost {
  double step_s, sigma_rad;
  template <class T>
  bool operator()(const T* from, const T* to, const T* ego, T* out) const {
    out[0] = (*to - *from + T(step_s) * ego[MountingParameters::kYawRateBias]) / T(sigma_rad);
    return true;
  }
};

/// Where a window's target is in the body frame of one look.
template <class T>
void PlaceInLook(const T* target, const LookPose& pose, T& x, T& y) {
  const T dx = target[0] + T(pose.dt_s) * target[2] - T(pose.x_m);
  const T dy = target[1] + T(pose.dt_s) * target[3] - T(pose.y_m);
  const double c = std::cos(pose.yaw_rad);
  const double s = std::sin(pose.yaw_rad);
  x = T(c) * dx + T(s) * dy;
  y = T(c) * dy - T(s) * dx;
}

/// Where a vehicle's reflections lie against the foot of its box, on average over vehicles, by the
/// aspect a it is seen under (its direction of motion against the ray). Mirror symmetry leaves
///
///     along the ray:  s0 + s1 cos a + s2 cos 2a        across:  s3 sin a + s4 sin 2a
inline constexpr int kShape = 5;

struct Aspect {
  double cos1 = 0.0, cos2 = 0.0, sin1 = 0.0, sin2 = 0.0;
};

/// What of it is left however many vehicles pass, radar by radar: a field of view that cuts them,
/// more reflections when nearer, boxes half hidden. Over azimuth a and range r
///
///     along the ray:  l0 + l1 sin a + l2 r        across:  l3 + l4 sin a + l5 r
///
/// Considered only: as an unknown it would be learnt from what it is to excuse.
inline constexpr int kLean = 6;

/// Parameters: radar | target; for vehicles that are no points also | offset of this chain's
/// reflections, along and across the ray | shape | lean of this radar. Of such vehicles a radar's
/// place is taken as it stands: where a vehicle reflects tells less of it than a tape measure.
struct RadarTargetCost {
  LookPose pose;
  double measured;  ///< Range, or azimuth.
  double sigma;
  bool is_azimuth;
  Aspect aspect;
  double range_m, sin_azimuth;  ///< Where the lean is taken.
  double radar_x_m, radar_y_m;  ///< As it stands.

  template <class T>
  bool operator()(const T* radar, const T* target, const T* offset, const T* shape, const T* lean,
                  T* out) const {
    T along = offset[0] + shape[0] + shape[1] * T(aspect.cos1) + shape[2] * T(aspect.cos2);
    T across = offset[1] + shape[3] * T(aspect.sin1) + shape[4] * T(aspect.sin2);
    along += lean[0] + lean[1] * T(sin_azimuth) + lean[2] * T(range_m);
    across += lean[3] + lean[4] * T(sin_azimuth) + lean[5] * T(range_m);
    const T as_it_stands[] = {T(radar_x_m), T(radar_y_m), radar[2]};
    return Compare(as_it_stands, target, along, across, out);
  }
  template <class T>
  bool operator()(const T* radar, const T* target, T* out) const {
    return Compare(radar, target, T(0.0), T(0.0), out);
  }

 private:
  template <class T>
  bool Compare(const T* radar, const T* target, const T& along, const T& across, T* out) const {
    using std::atan2;
    using std::sqrt;
    T x;
    T y;
    PlaceInLook(target, pose, x, y);
    x -= radar[0];
    y -= radar[1];
    const T range = sqrt(x * x + y * y);
    if (!(range > T(0.5))) return false;
    if (is_azimuth) {
      const T off = T(measured) - across / range - (atan2(y, x) - radar[2]);
      out[0] = atan2(sin(off), cos(off)) / T(sigma);
    } else {
      out[0] = (T(measured) - along - range) / T(sigma);
    }
    return true;
  }
};

/// Parameters: camera | target | nod.
struct BoxCost {
  const CameraConfig* camera;
  LookPose pose;
  double measured_px;
  double sigma_px;
  bool is_row;
  template <class T>
  bool operator()(const T* mounting, const T* target, const T* nod, T* out) const {
    T x;
    T y;
    PlaceInLook(target, pose, x, y);
    T u;
    T v;
    if (!ProjectGround(*camera, mounting, x, y, *nod, u, v)) return false;
    out[0] = (T(measured_px) - (is_row ? v : u)) / T(sigma_px);
    return true;
  }
};

/// One unknown against what is known of it beforehand.
struct PriorCost {
  int index;
  double mean, sigma;
  template <class T>
  bool operator()(const T* block, T* out) const {
    out[0] = (block[index] - T(mean)) / T(sigma);
    return true;
  }
};

}  // namespace v2vouch
