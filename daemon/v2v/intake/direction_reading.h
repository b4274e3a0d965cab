// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "daemon/common/base/time.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// What a sender's heading and unsigned speed mean while it may be backing. J2735's heading is the
/// direction of motion, but many units send that of the body, and many do not know their gear.
///
///     v = s u or -s u,  u = heading as sent, s = speed as sent
///
/// *Which of the two* is decided by displacement, whatever the first message suggested: D = way
/// between the claimed places, W = integral of s u dt over at least kLeastWay_m;
/// D . W > |D||W| / 2 is motion along the heading, < -|D||W| / 2 motion against it. Until then the
/// last decision holds; in reverse gear the reading in which the body keeps its direction.
/// *The body's direction* is against v in reverse gear; without a gear it keeps its direction as
/// long as the vehicle is no faster than kMostReverse_mps (faster is forwards).
///
/// A sender that reports a forward gear is read as it says: places that move against its heading
/// are then a contradiction, for the path check to judge. Fixed size.
class DirectionReading {
 public:
  /// Rewrites course and speed of `claim`, which ToClaim has read as the standard says.
  /// @return true where the meaning of earlier claims has changed: memory of them is void. At most
  ///   once in kPatience_s, so that a sender cannot clear its record at will.
  bool Read(Transmission transmission, Claim& claim);

  static constexpr double kLeastWay_m = 1.5;
  static constexpr double kMostReverse_mps = 6.0;
  static constexpr double kPatience_s = 3.0;

 private:
  bool Settle(const Claim& claim, const Eigen::Vector3d& u, double speed_mps);
  bool Follow(Transmission transmission, const Claim& claim, const Eigen::Vector3d& u,
              double speed_mps);

  bool has_last_ = false;
  Timestamp last_{};
  Transmission transmission_ = Transmission::kUnavailable;
  Eigen::Vector3d u_ = Eigen::Vector3d::Zero();       // Heading as sent last time, with course.
  Eigen::Vector3d course_ = Eigen::Vector3d::Zero();  // As read last time.
  double read_mps_ = 0.0;                             // Speed as read last time.
  bool is_against_ = false;                           // Motion goes against the heading.
  bool is_settled_ = false;                           // By displacement.
  Eigen::Vector3d from_E_ = Eigen::Vector3d::Zero();  // D and W since here.
  Eigen::Vector3d way_ = Eigen::Vector3d::Zero();
  Timestamp reread_{};
};

}  // namespace v2vouch
