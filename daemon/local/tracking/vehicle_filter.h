// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "daemon/common/models/ctra.h"
#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/point_filter.h"
#include "daemon/local/tracking/sensor_look.h"

namespace v2vouch {

/// What the filter has to know beside the measurement.
struct FilterSettings {
  MotionNoise motion;
  bool point_targets = false;  ///< Detections are of the centre: no extent model.
};

/// Filter of a vehicle with size (ExtendedState: CTRA, length, width), as a Gaussian mixture over
/// the direction of its axis. A moving vehicle has one component. One that was never seen moving
/// starts with four, its axis along, across and diagonal to a likely direction: which of them the
/// silhouettes and reflections fit is decided by Bayes' rule, component by component, and those
/// that do not fit are dropped.
///
/// The size starts with that of a class, and a class is only a name: where box after box, or the
/// spread of cluster after cluster, fits any size better than this one, the size is forgotten and
/// learnt anew, from what is seen alone.
class VehicleFilter {
 public:
  static constexpr std::size_t kMostAxes = 4;

  VehicleFilter() = default;
  /// Copies what is in use only: checkpoints copy every track.
  VehicleFilter(const VehicleFilter& other) { *this = other; }
  VehicleFilter& operator=(const VehicleFilter& other);

  /// From a point whose velocity gives the direction.
  void StartMoving(const PointFilter& point, const Extent& size, const Eigen::Vector2d& seen_from_O,
                   const FilterSettings& settings);
  /// From a point that stands; its axis is likely to lie along or across `likely_yaw_rad`.
  void StartStanding(const PointFilter& point, double likely_yaw_rad, const Extent& size,
                     const Eigen::Vector2d& seen_from_O, const FilterSettings& settings);

  /// From a pose, which knows the direction; with this size.
  void StartAt(const PoseMeasurement& pose, const Extent& size);
  /// From a box, which knows axis and size and nothing of the motion.
  void StartAt(const BoxMeasurement& box);

  void Predict(double dt_s, const FilterSettings& settings);

  /// Likelihood under the whole mixture: the squared distance is that of the best component.
  template <class Look, class Measurement>
  [[nodiscard]] std::optional<Likelihood> Evaluate(const Look& look, const Measurement& z,
                                                   ObjectClass object_class,
                                                   const FilterSettings& settings) const;
  /// @param is_young linearised twice: range rate bends strongly over an uncertain heading.
  /// @return false on numerical failure in every component.
  template <class Look, class Measurement>
  bool Update(const Look& look, const Measurement& z, bool is_young,
              const FilterSettings& settings);

  /// A whole pose; to be asked only where knows_direction().
  [[nodiscard]] std::optional<Likelihood> Evaluate(const PoseMeasurement& z) const;
  bool Update(const PoseMeasurement& z);
  /// A box; to be asked only where knows_direction(). Gated by position alone; axis and size add
  /// their likelihood to log_det, relative to clutter's and bounded from below, since detectors
  /// turn boxes by a quarter or cut them short.
  [[nodiscard]] std::optional<Likelihood> Evaluate(const BoxMeasurement& z) const;
  bool Update(const BoxMeasurement& z);
  /// Of a vehicle not seen in motion yet: its front is taken to be the end towards `yaw_rad`.
  void FaceTowards(double yaw_rad);
  void AssumeSpeed(double speed_mps, double sigma_mps);
  /// One axis is left, and its front is known.
  [[nodiscard]] bool knows_direction() const { return count_ == 1 && has_driven_; }

  /// Seen in motion: front and rear are told apart.
  [[nodiscard]] bool has_driven() const { return has_driven_; }

  /// The next returns may set the near face anew (what they lie in is worth asking).
  [[nodiscard]] bool may_move_face() const;

  /// The size has been forgotten once: no name of a class means anything to it any more.
  [[nodiscard]] bool is_size_open() const { return is_size_open_; }
  void AssumeClass(ObjectClass from, ObjectClass to, const Eigen::Vector2d& seen_from_O);
  void Lengthen(double length_m, double sigma_m, const Eigen::Vector2d& seen_from_O);

  /// The likeliest component; its position is the mixture's mean, its position covariance and the
  /// variance of its speed widened by the spread between the components.
  [[nodiscard]] ExtendedState Show() const;
  [[nodiscard]] Eigen::Matrix2d position_covariance() const;  ///< As shown.
  /// The likeliest component.
  [[nodiscard]] const ExtendedState& best() const { return components_[0].state; }
  [[nodiscard]] std::size_t axes() const { return count_; }

 private:
  struct Component {
    ExtendedState state;
    double weight = 1.0;
  };
  enum class Box { kFits, kOtherSize, kTurned };
  template <class Look, class Measurement>
  Box Judge(const Look& look, const Measurement& z, const FilterSettings& settings) const;
  void NoteDepth(const RadarMeasurement& z, const Linearized& model);
  void NoteDepth(const CameraMeasurement&, const Linearized&) {}
  [[nodiscard]] bool IsOffFace(const RadarMeasurement& z, const Linearized& model) const;
  [[nodiscard]] bool IsOffFace(const CameraMeasurement&, const Linearized&) const { return false; }
  void Reopen(bool is_larger, const Eigen::Vector2d& seen_from_O);
  void Weigh(std::span<const double> log_likelihoods);
  void TurnRound();

  std::array<Component, kMostAxes> components_;  // The first count_ are in use, likeliest first.
  std::size_t count_ = 0;
  bool has_driven_ = false;  // Seen in motion: front and rear are told apart.
  bool is_size_open_ = false;
  int odd_boxes_ = 0;         // In a row that fit another size.
  int odd_spans_ = 0;         // Clusters too wide for it, three each, less those that were not.
  double usual_depth_ = 0.0;  // Of the outline's returns behind the expected one, in sigmas.
  bool is_deep_ = false;      // One of them was too deep: none is taken off.
};

/// The same motion with front and rear exchanged.
void FaceAbout(ExtendedState& state);

/// A vehicle whose reflecting point is known and whose direction is `yaw_rad`, given (with
/// `yaw_sigma_rad`) or, where `yaw_sigma_rad` is 0, that of the point's velocity: centre, motion
/// and size with the covariances that tie the centre to direction and size.
ExtendedState VehicleAt(const PointFilter& point, double yaw_rad, double yaw_sigma_rad,
                        const Extent& size, const Eigen::Vector2d& seen_from_O,
                        const FilterSettings& settings);

}  // namespace v2vouch
