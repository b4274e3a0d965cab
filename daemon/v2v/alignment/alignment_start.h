// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "daemon/v2v/alignment/alignment_filter.h"

namespace v2vouch {

/// Finds which way O lies in L, from whatever a receiver gives, and starts a filter there.
///
/// At once: a heading of the car (better than 0.3 rad, and not against the course), or a course
/// over ground above `min_course_speed_mps`. Else, from a receiver of positions only, or from one
/// in a car that crawls and stops, by the rotation that fits best what was driven in O and in L
/// (least squares; Horn's closed form in the plane):
///
///     yaw = atan2( sum w (a_O x a_L), sum w (a_O . a_L) ),   var = 1 / sum w |a_O|^2
///
/// over a = places from their mean and a = velocities, each with the weight of its own accuracy and
/// correlation time; starts once sigma is 0.1 rad and, for places, the way 5 m. What O turns while
/// the car stands is taken out. Fixes whose way differs from the odometry's are left out; where
/// most do, it begins anew. Copyable.
class AlignmentStart {
 public:
  /// @param fix in the plane the filter is to be in; the same plane for all fixes since Reset.
  std::optional<AlignmentFilter> OnFix(const FixInPlane& fix, const EgoState& ego,
                                       const Eigen::Vector2d& antenna_B,
                                       double min_course_speed_mps, double jump_m);
  /// Forgets all fixes.
  void Reset() { *this = AlignmentStart(); }

 private:
  // A weighted sum of what two sets of vectors say of the rotation between them.
  struct Rotation {
    double dot = 0.0;
    double cross = 0.0;
    double weight = 0.0;  // Of the squares in O: 1 / variance of the yaw.
    void Add(const Eigen::Vector2d& in_O, const Eigen::Vector2d& in_L, double w) {
      dot += w * in_O.dot(in_L);
      cross += w * (in_O.x() * in_L.y() - in_O.y() * in_L.x());
      weight += w * in_O.squaredNorm();
    }
  };

  void Follow(const EgoState& ego);
  void AddVelocity(const FixInPlane& fix, const EgoState& ego, const Eigen::Vector2d& antenna_B);
  void AddPlace(const FixInPlane& fix, const EgoState& ego, const Eigen::Vector2d& antenna_B,
                double jump_m);
  void Begin(const Eigen::Vector2d& place_O, const Eigen::Vector2d& place_L, double sigma_m);
  [[nodiscard]] std::optional<AlignmentFilter> Solve(const FixInPlane& fix, const EgoState& ego,
                                                     const Eigen::Vector2d& antenna_B) const;

  std::optional<EgoState> last_;
  Eigen::Vector2d body_ = Eigen::Vector2d::Zero();  // In O without the turns at standstill ...
  double held_rad_ = 0.0;                           // ... which come to this.
  // Places.
  int places_ = 0;
  int misfits_ = 0;
  Eigen::Vector2d first_O_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d first_L_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d newest_O_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_O_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_L_ = Eigen::Vector2d::Zero();
  double sigma_m_ = 0.0;  // The worst.
  double colour_ = 1.0;   // How many fixes are worth one.
  Timestamp placed_{};
  Rotation way_;  // Weighted by 1; sigma_m_ and colour_ come in at the end.
  // Velocities.
  std::optional<Timestamp> timed_;
  Rotation velocity_;
};

}  // namespace v2vouch
