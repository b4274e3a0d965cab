// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>

#include "daemon/local/tracking/sensor_look.h"

namespace v2vouch {

/// The last boxes of a track that only cameras have seen, kept to test positions against: a
/// stationary object must have been in all of these directions, and under the right depression.
class Glances {
 public:
  static constexpr std::size_t kMost = 8;

  /// Boxes with a cut side say nothing; one with a cut bottom gives its bearings only.
  void Add(const CameraLook& look, const CameraMeasurement& z);
  [[nodiscard]] std::size_t size() const { return count_; }

  /// How badly a stationary point at `p_O` fits: sum over the boxes of squared, normalised
  /// depression errors. nullopt where it is outside of the bearings of a box.
  [[nodiscard]] std::optional<double> Misfit(const Eigen::Vector2d& p_O) const;
  /// Distance of a point from where the last box was seen.
  [[nodiscard]] double RangeTo(const Eigen::Vector2d& p_O) const;

 private:
  struct Glance {
    Eigen::Vector2d from_O = Eigen::Vector2d::Zero();
    double middle_rad = 0.0;                            // Of the bearings, in O.
    Eigen::Vector2d middle = Eigen::Vector2d::UnitX();  // The same as a direction.
    double beside = 0.0;    // Tangent of the half below, and a little more; 0: not asked.
    double half_rad = 0.0;  // Half of the box's width, with one sigma of its edges.
    double height_m = 0.0;  // Of the camera.
    double depression_rad = 0.0;
    double weight = 0.0;  // 1 / variance; 0 where the bottom is cut.
  };
  std::array<Glance, kMost> glances_;  // A ring.
  std::size_t count_ = 0;
  std::size_t last_ = 0;
};

}  // namespace v2vouch
