// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

/// The blocks of an attack's `change` list (attack_spec.h). "along" is the direction of the claimed
/// heading, "left" is left of it; east and north are axes of the world frame W.
namespace v2vouch::sim {

/// When an attack, or one of its blocks, is at work: from the first moment on at which all that is
/// given holds. "The vehicle" is the one spoken for; in joint view = detectable by a radar and a
/// camera, each with probability 0.5 at least, 5 to 100 m from the ego, by truth geometry.
struct WhenSpec {
  double start_s = 0.0;          ///< Of the scenario.
  double stop_s = 0.0;           ///< Of the scenario; 0 = never.
  double after_s = 0.0;          ///< Since the attack began; for blocks.
  double after_in_view_s = 0.0;  ///< The vehicle has been in joint view for so long.
  double after_hidden_s = 0.0;   ///< ... and then hidden ahead for so long; 0 = need not.
  double ego_above_mps = 0.0;    ///< The ego drives faster.
  double active_s = 0.0;         ///< At work so long, ...
  double pause_s = 0.0;          ///< ... honest so long, again and again; 0 = without pause.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("start_s", start_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("stop_s", stop_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("after_s", after_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("after_in_view_s", after_in_view_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("after_hidden_s", after_hidden_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("ego_above_mps", ego_above_mps, {.at_least = 0.0, .at_most = 70.0});
    a.Field("active_s", active_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("pause_s", pause_s, {.at_least = 0.0, .at_most = 1e5});
  }
};

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

/// Another size.
struct SizeChangeSpec {
  double scale = 1.0;
  bool swap = false;       ///< Length for width.
  double random_to = 0.0;  ///< Per message: both times a factor from 0.3 to here; 0 = not.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("scale", scale, {.above = 0.0, .at_most = 20.0});
    a.Field("swap", swap);
    a.Field("random_to", random_to, {.at_least = 0.0, .at_most = 20.0});
  }
};

/// Another reported accuracy.
struct AccuracySpec {
  double semi_major_m = 12.7;
  bool unavailable = false;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
    a.Field("unavailable", unavailable);
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

/// Says what was so a while ago.
struct DelaySpec {
  double low_s = 1.0;    ///< Age, drawn once from here ...
  double high_s = 1.0;   ///< ... to here.
  int messages = 0;      ///< Instead: so many messages ago.
  bool restamp = false;  ///< Stamps of now instead of the content's own.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("low_s", low_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("high_s", high_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("messages", messages, {.at_least = 0, .at_most = 6000});
    a.Field("restamp", restamp);
  }
};

/// Sends messages again that were sent before.
struct ReplaySpec {
  enum class Of { kOwn, kVictim };
  enum class Stamps {
    kKept,    ///< Bit for bit, but for a victim's identity and count.
    kFresh,   ///< secMark and signature of now.
    kMinute,  ///< As if exactly 60.000 s old: secMark of now, signature of a minute ago.
  };
  Of of = Of::kOwn;
  double age_s = 6.0;       ///< Older than all that was sent: reckoned back at constant velocity.
  int low = 6;              ///< Of a victim: so many messages at a time, from here ...
  int high = 6;             ///< ... to here, then the next victim.
  double within_m = 400.0;  ///< Victims are heard from within this distance.
  Stamps stamps = Stamps::kKept;

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("of", of, {{"own", Of::kOwn}, {"victim", Of::kVictim}});
    a.Field("age_s", age_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("low", low, {.at_least = 1, .at_most = 1000});
    a.Field("high", high, {.at_least = 1, .at_most = 1000});
    a.Field("within_m", within_m, {.above = 0.0, .at_most = 1e5});
    a.Choice("stamps", stamps,
             {{"kept", Stamps::kKept}, {"fresh", Stamps::kFresh}, {"minute", Stamps::kMinute}});
  }
};

/// A new TemporaryID, certificate and message count; the parts add up.
struct IdentityChangeSpec {
  int every_messages = 0;  ///< 0 = not.
  double every_s = 0.0;    ///< 0 = not.
  bool at_once = false;    ///< One with the block's beginning.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("every_messages", every_messages, {.at_least = 0, .at_most = 100000});
    a.Field("every_s", every_s, {.at_least = 0.0, .at_most = 1e5});
    a.Field("at_once", at_once);
  }
};

/// The TemporaryID of another sender: of the vehicle spoken for if it talks, else of the talking
/// vehicle longest in joint view.
struct ImpersonateSpec {
  enum class Certificate { kOwn, kNone };
  std::uint32_t vehicle = 0;                    ///< 0 = as said above.
  Certificate certificate = Certificate::kOwn;  ///< kNone: signature state unknown.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle, {.at_most = 4e9});
    a.Choice("certificate", certificate,
             {{"own", Certificate::kOwn}, {"none", Certificate::kNone}});
  }
};

/// So many times as many messages, evenly spread, each with the place it claims to have then.
struct RateSpec {
  double times = 4.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("times", times, {.at_least = 1.0, .at_most = 2000.0});
  }
};

/// One item of `change`: exactly one block, and when it is at work within the attack.
struct ChangeSpec {
  std::optional<OffsetSpec> offset;
  std::optional<DriftSpec> drift;
  std::optional<BrakeSpec> brake;
  std::optional<FreezeSpec> freeze;
  std::optional<EventualStopSpec> eventual_stop;
  std::optional<SpeedChangeSpec> speed;
  std::optional<HeadingChangeSpec> heading;
  std::optional<AccelerationChangeSpec> acceleration;
  std::optional<SizeChangeSpec> size;
  std::optional<AccuracySpec> accuracy;
  std::optional<MirrorSpec> mirror;
  std::optional<RotateSpec> rotate;
  std::optional<DelaySpec> delay;
  std::optional<ReplaySpec> replay;
  std::optional<IdentityChangeSpec> identity;
  std::optional<ImpersonateSpec> impersonate;
  std::optional<RateSpec> rate;
  WhenSpec when;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("offset", offset);
    a.Field("drift", drift);
    a.Field("brake", brake);
    a.Field("freeze", freeze);
    a.Field("eventual_stop", eventual_stop);
    a.Field("speed", speed);
    a.Field("heading", heading);
    a.Field("acceleration", acceleration);
    a.Field("size", size);
    a.Field("accuracy", accuracy);
    a.Field("mirror", mirror);
    a.Field("rotate", rotate);
    a.Field("delay", delay);
    a.Field("replay", replay);
    a.Field("identity", identity);
    a.Field("impersonate", impersonate);
    a.Field("rate", rate);
    a.Field("when", when);
  }
};

}  // namespace v2vouch::sim
