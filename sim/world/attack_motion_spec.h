// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

/// The blocks of an attack's `change` list (attack_change_spec.h) that change where the vehicle is
/// said to be and how it moves. "along" is the direction of the claimed heading, "left" is left of
/// it; east and north are axes of the world frame W.
namespace v2vouch::sim {

/// How often a value is drawn.
enum class Draw { kOnce, kPerMessage };

template <class Archive>
void VisitDraw(Archive& a, Draw& draw) {
  a.Choice("draw", draw, {{"once", Draw::kOnce}, {"per_message", Draw::kPerMessage}});
}

/// Another place; the parts add up.
struct OffsetSpec {
  double along_m = 0.0;
  double left_m = 0.0;
  double east_m = 0.0;
  double north_m = 0.0;
  double low_m = 0.0;       ///< Drawn on top, east and north each: a length from here ...
  double high_m = 0.0;      ///< ... to here, with either sign.
  double distance_m = 0.0;  ///< Drawn on top: so far in any direction.
  Draw draw = Draw::kOnce;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("along_m", along_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("left_m", left_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("east_m", east_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("north_m", north_m, {.at_least = -1e5, .at_most = 1e5});
    a.Field("low_m", low_m, {.at_least = 0.0, .at_most = 1e5});
    a.Field("high_m", high_m, {.at_least = 0.0, .at_most = 1e5});
    a.Field("distance_m", distance_m, {.at_least = 0.0, .at_most = 1e5});
    VisitDraw(a, draw);
  }
};

/// An offset that grows from 0.
struct DriftSpec {
  double along_mps = 0.0;
  double left_mps = 0.0;
  double east_mps = 0.0;
  double north_mps = 0.0;
  double limit_m = 0.0;    ///< Stops growing there; 0 = never.
  bool consistent = true;  ///< Speed and heading claimed are those of the false motion.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("along_mps", along_mps, {.at_least = -100.0, .at_most = 100.0});
    a.Field("left_mps", left_mps, {.at_least = -100.0, .at_most = 100.0});
    a.Field("east_mps", east_mps, {.at_least = -100.0, .at_most = 100.0});
    a.Field("north_mps", north_mps, {.at_least = -100.0, .at_most = 100.0});
    a.Field("limit_m", limit_m, {.at_least = 0.0, .at_most = 1e5});
    a.Field("consistent", consistent);
  }
};

/// From the place and speed last claimed it brakes to a stop along its heading, and stays.
struct BrakeSpec {
  double decel_mps2 = 3.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("decel_mps2", decel_mps2, {.above = 0.0, .at_most = 20.0});
  }
};

/// What was said first stays.
struct FreezeSpec {
  bool position = true;
  bool speed = false;
  bool heading = false;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("position", position);
    a.Field("speed", speed);
    a.Field("heading", heading);
  }
};

/// With each message a stop becomes likelier; from then on the place stays (VeReMi attack 16).
struct EventualStopSpec {
  double probability = 0.0;  ///< Of the first message ...
  double growth = 0.025;     ///< ... and this much more with each.
  bool zero_speed = true;    ///< Claims speed 0, too.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("probability", probability, {.at_least = 0.0, .at_most = 1.0});
    a.Field("growth", growth, {.at_least = 0.0, .at_most = 1.0});
    a.Field("zero_speed", zero_speed);
  }
};

/// Another speed: scaled, then set, then added to.
struct SpeedChangeSpec {
  double scale = 1.0;
  std::optional<double> set_mps;
  double random_to_mps = 0.0;  ///< Set to any value from 0 to here; 0 = not.
  double low_mps = 0.0;        ///< Drawn and added: from here ...
  double high_mps = 0.0;       ///< ... to here, with either sign.
  Draw draw = Draw::kOnce;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("scale", scale, {.at_least = -10.0, .at_most = 10.0});
    a.Field("set_mps", set_mps, {.at_least = -70.0, .at_most = 150.0});
    a.Field("random_to_mps", random_to_mps, {.at_least = 0.0, .at_most = 150.0});
    a.Field("low_mps", low_mps, {.at_least = 0.0, .at_most = 150.0});
    a.Field("high_mps", high_mps, {.at_least = 0.0, .at_most = 150.0});
    VisitDraw(a, draw);
  }
};

/// Another heading, counter-clockwise positive.
struct HeadingChangeSpec {
  double add_rad = 0.0;
  double per_message_rad = 0.0;  ///< Grows by this with each message.

  template <class Archive>
  void Visit(Archive& a) {
    a.Degrees("add_deg", add_rad, {.at_least = -360.0, .at_most = 360.0});
    a.Degrees("per_message_deg", per_message_rad, {.at_least = -360.0, .at_most = 360.0});
  }
};

/// Another acceleration: scaled by a factor drawn from low to high, or set; and the brake lights.
struct AccelerationChangeSpec {
  enum class Lights { kByDeceleration, kOn, kOff };
  double low_scale = 1.0;
  double high_scale = 1.0;
  std::optional<double> set_mps2;
  Lights brakes = Lights::kByDeceleration;
  Draw draw = Draw::kOnce;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("low_scale", low_scale, {.at_least = -20.0, .at_most = 20.0});
    a.Field("high_scale", high_scale, {.at_least = -20.0, .at_most = 20.0});
    a.Field("set_mps2", set_mps2, {.at_least = -20.0, .at_most = 20.0});
    a.Choice(
        "brakes", brakes,
        {{"by_deceleration", Lights::kByDeceleration}, {"on", Lights::kOn}, {"off", Lights::kOff}});
    VisitDraw(a, draw);
  }
};

/// As far on the other side of the road's centre line as it is on this one.
struct MirrorSpec {
  double centre_left_m = 0.0;  ///< Of the vehicle; 0 = by its route's `centre_m`, else 1.75.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("centre_left_m", centre_left_m, {.at_least = -100.0, .at_most = 100.0});
  }
};

/// Turned about where the ego's rear axle truly is at the message's time, counter-clockwise
/// positive; heading and speed stay: as if the ego's sensors looked to the side.
struct RotateSpec {
  double about_ego_rad = 0.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Degrees("about_ego_deg", about_ego_rad, {.at_least = -180.0, .at_most = 180.0});
  }
};

}  // namespace v2vouch::sim
