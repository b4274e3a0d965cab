// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/visit.h"
#include "sim/world/attack_message_spec.h"
#include "sim/world/attack_motion_spec.h"

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
