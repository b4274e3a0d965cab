// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "daemon/common/data/object_class.h"
#include "sim/sensors/subject.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// What goes on from picture to picture in a camera of a sensor family (CameraFamilySpec): body
/// pitch, and per vehicle its edges' slow errors, its class as read, misses and split boxes; and
/// the places of false boxes. Pictures must come in order of time.
class CameraFamily {
 public:
  CameraFamily(const CameraFamilySpec& spec, std::uint64_t index, std::uint64_t seed);

  struct Vehicle {
    std::array<double, 4>
        edge{};  ///< Slow errors in units of their sigma: left, top, right, bottom.
    bool is_amodal = false;
    bool is_missed = false;
    bool is_split = false;
    ObjectClass read_as = ObjectClass::kUnknown;

    double time_s = 0.0;  ///< Of the last picture; the rest is when each spell ends.
    double class_until_s = 0.0;
    double missed_until_s = 0.0;
    double split_until_s = 0.0;
  };
  struct FalseBox {
    Vec2 place;  ///< Fixed to the world.
    double width_m;
    double height_m;
    ObjectClass object_class;
    double until_s;
  };

  /// Begins a picture. @return the body's pitch beyond the mounting, down positive [rad].
  double Begin(const EgoTruth& ego, double time_s, std::int64_t seq, double half_fov_rad);
  /// The vehicle's state in this picture.
  const Vehicle& See(const Actor& actor, std::int64_t seq);
  [[nodiscard]] const std::vector<FalseBox>& false_boxes() const { return false_boxes_; }

 private:
  CameraFamilySpec spec_;
  std::uint64_t index_;
  std::uint64_t seed_;
  double time_s_ = 0.0;
  bool has_begun_ = false;
  double pitch_rad_ = 0.0;
  std::map<std::uint32_t, Vehicle> vehicles_;
  std::vector<FalseBox> false_boxes_;
};

}  // namespace v2vouch::sim
