// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/common/data/input.h"
#include "daemon/common/data/track.h"
#include "daemon/common/models/ctra.h"
#include "daemon/common/models/measurement_model.h"

namespace v2vouch {

/// Typical footprint of a class with its spread in traffic; kUnknown is a car that may be anything
/// up to a van.
Extent ClassExtent(ObjectClass object_class);
/// Lorries and buses: their length is not to be guessed from a part.
inline bool IsLong(ObjectClass object_class) {
  return object_class == ObjectClass::kTruck || object_class == ObjectClass::kBus;
}
/// Articulated lorries with some tolerance: 16.5 m and 18.75 m are the limits of 96/53/EC.
inline constexpr double kLongestVehicle_m = 18.75;

/// Vehicle whose size is estimated together with its motion. The near face is measured well, the
/// centre lies half a length behind it: only the joint covariance knows that a longer vehicle is
/// also farther away.
struct ExtendedState {
  static constexpr int kLength = kStateSize;
  static constexpr int kWidth = kStateSize + 1;
  static constexpr int kDepth = kStateSize + 2;  ///< Lasting offsets of radar, see
  static constexpr int kAside = kStateSize + 3;  ///< radar_outline.h.
  static constexpr int kSize = kStateSize + 4;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  Vector mean = Vector::Zero();  ///< StateIndex, then length and width [m], then the offsets.
  Matrix covariance = Matrix::Identity();

  [[nodiscard]] KinematicState kinematic() const;
  [[nodiscard]] Extent extent() const;
  /// The size with sigmas of 0: what the measurement models are to be given, because the joint
  /// covariance carries the uncertainty already.
  [[nodiscard]] Extent assumed_extent() const;
};

/// Nothing is known of the lasting offsets of radar: their stationary distribution.
void AssumeOffsets(ExtendedState& state);

/// PredictCtra of the motion, where long vehicles turn more slowly at speed; the size keeps a
/// little process noise, so that it never freezes.
void PredictExtended(ExtendedState& state, double dt_s, const MotionNoise& noise);

/// Joint Joseph update of motion and size. Length and width are kept within what drives on roads
/// (0.3 to 25 m, 0.3 to 4 m), yaw is wrapped.
/// @param learns_size false: the size is only considered. A radar's mean reflection depends on the
///   length through which faces are seen; small errors of that model, the same in every scan, would
///   pass for knowledge of the length.
/// @param frozen bit i set: state i is only considered too.
/// @return false on numerical failure; state untouched.
bool UpdateExtended(const Linearized& measurement, ExtendedState& state, bool learns_size = true,
                    unsigned frozen = 0);
std::optional<Likelihood> EvaluateExtended(const Linearized& measurement,
                                           const ExtendedState& state);
/// The same for a whole pose, which has nothing to do with the size but by correlation.
bool UpdateExtended(const LinearizedPose& measurement, ExtendedState& state);
std::optional<Likelihood> EvaluateExtended(const LinearizedPose& measurement,
                                           const ExtendedState& state);

/// Replaces what was assumed about the size: takes the typical size of `from` out of the estimate
/// (information filter), puts that of `to` in, and moves the vehicle as the joint covariance says:
/// the face that was measured stays where it is.
void AssumeClass(ObjectClass from, ObjectClass to, ExtendedState& state);

/// AssumeClass for a short vehicle that turns out to be a lorry or bus: only its near face was
/// seen, and that not well, since the mean of reflections was taken for a short vehicle's. The face
/// stays where it is, 1.5 m uncertain along the axis; the centre lies half of the new length behind
/// it.
void AssumeLongClass(ObjectClass to, const Eigen::Vector2d& seen_from_O, ExtendedState& state);

/// Forgets the size, as nothing of it agrees with what is seen: any vehicle's from here on, a car's
/// to begin with, or what it was where that is more and more is wanted. The near face stays where
/// it is, 1.5 m uncertain along the axis.
void ReopenSize(bool is_larger, const Eigen::Vector2d& seen_from_O, ExtendedState& state);

/// Makes the vehicle at least `length_m` long, which is uncertain by `sigma_m`: it grows away from
/// `seen_from_O`, the face that was measured stays where it is. Shorter ones leave it alone.
void Lengthen(double length_m, double sigma_m, const Eigen::Vector2d& seen_from_O,
              ExtendedState& state);

/// What the spread of one cluster says about the size, for a vehicle of known motion: returns of
/// one vehicle span no more than its box does,
///
///     radial span <= L |cos a| + W |sin a|,   azimuth span <= (L |sin a| + W |cos a|) / r
///
/// so a wider cluster makes the vehicle longer, and a narrower one says nothing: it may be a part.
/// @return nullopt where the cluster fits into the box, has one return, or comes from a sensor that
///   tracks by itself.
std::optional<Linearized> LinearizeSpan(const ExtendedState& state, const EgoState& ego,
                                        const RadarConfig& radar,
                                        const RadarMeasurement& measurement);

/// The size alone, for filters that take the motion from elsewhere: one silhouette width or span.
///     d = length |sin a| + width |cos a|,  a: aspect of the vehicle to the line of sight
void UpdateExtent(double across_m, double across_sigma_m, double aspect_rad, Extent& extent);

}  // namespace v2vouch
