// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/common/base/visit.h"
#include "sim/world/attack_change_spec.h"

/// Section `attacks` of a scenario: who lies, from when on, along what path, and how what is said
/// is changed. `path` gives a first version of each message, `change` is a list of blocks that each
/// alter it in turn, so that lies compose. Everything acts before J2735's integers are made, on a
/// message that has the receiver errors, latency and radio loss of any other; its signature is
/// valid.
namespace v2vouch::sim {

/// The transmitters; exactly one of the three. Two attacks with the same `share` have the same
/// ones.
struct WhoSpec {
  std::vector<std::uint32_t> vehicles;  ///< By id; each must talk.
  double share = 0.0;  ///< Of the vehicles that talk, at least one, drawn from the seed.
  int devices = 0;     ///< Transmitters carried along 30 m behind the ego, no vehicle of their own.
  double min_in_view_s = 0.0;  ///< `share` prefers vehicles in joint view for so long in the run.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicles", vehicles, {.at_least = 1, .at_most = 4e9});
    a.Field("share", share, {.at_least = 0.0, .at_most = 1.0});
    a.Field("devices", devices, {.at_least = 0, .at_most = 1000});
    a.Field("min_in_view_s", min_in_view_s, {.at_least = 0.0, .at_most = 1e5});
  }
};

/// A claimed vehicle that does not exist, ahead of the ego on the way it will drive; of car size.
struct GhostSpec {
  enum class Moves { kWithEgo, kStands };
  double ahead_m = 30.0;  ///< Between the two centres.
  bool at_stopping_distance =
      false;                      ///< Instead: 1.5 v + v^2 / 13.7 - 0.1 (VASP), bumper to bumper.
  double left_m = 0.0;            ///< Of the ego's way.
  Moves moves = Moves::kWithEgo;  ///< Copies the ego's speed; or stays where it first was.
  double closing_m = 0.0;         ///< Comes so much nearer with each message ...
  double nearest_m = 6.0;         ///< ... down to this.
  std::optional<double> accel_mps2;  ///< Claimed instead of the motion's own.
  double semi_major_m = 0.5;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("ahead_m", ahead_m, {.at_least = -300.0, .at_most = 1000.0});
    a.Field("at_stopping_distance", at_stopping_distance);
    a.Field("left_m", left_m, {.at_least = -50.0, .at_most = 50.0});
    a.Choice("moves", moves, {{"with_ego", Moves::kWithEgo}, {"stands", Moves::kStands}});
    a.Field("closing_m", closing_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("nearest_m", nearest_m, {.at_least = 0.0, .at_most = 1000.0});
    a.Field("accel_mps2", accel_mps2, {.at_least = -20.0, .at_most = 20.0});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
  }
};

/// Speaks for a real vehicle, as if from aboard: seen by other means, a little late and noisy.
struct ShadowSpec {
  std::uint32_t vehicle = 0;  ///< 0 = the driving one longest in joint view, of the kind below.
  bool has_v2v = false;       ///< Of vehicles that talk, or of those that do not.
  bool gets_hidden = false;   ///< Only of those that later get hidden; the longest hidden one.
  int count = 1;              ///< Identities, each with a noise of its own.
  double delay_s = 0.3;       ///< Age of what is said; stamps are fresh.
  double noise_m = 0.7;       ///< Gauss-Markov per axis, time constant 5 s.
  double semi_major_m = 0.5;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle, {.at_most = 4e9});
    a.Field("has_v2v", has_v2v);
    a.Field("gets_hidden", gets_hidden);
    a.Field("count", count, {.at_least = 1, .at_most = 100});
    a.Field("delay_s", delay_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("noise_m", noise_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
  }
};

/// Phantoms round something real, each with an identity of its own, moving as it does (F2MD
/// GridSybil).
struct GridSpec {
  enum class Round { kAttacker, kEgo, kVehicle };
  Round round = Round::kAttacker;  ///< kVehicle: the driving one longest in joint view.
  int count = 5;
  double along_m = 5.0;        ///< Free way between them; one vehicle length comes on top.
  double across_m = 2.0;       ///< The same to the side.
  double jitter = 0.1;         ///< Of their places, a share of the spacing, drawn per phantom.
  double speed_spread = 0.05;  ///< Of the claimed speeds, drawn per phantom.

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("round", round,
             {{"attacker", Round::kAttacker}, {"ego", Round::kEgo}, {"vehicle", Round::kVehicle}});
    a.Field("count", count, {.at_least = 1, .at_most = 100});
    a.Field("along_m", along_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("across_m", across_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("jitter", jitter, {.at_least = 0.0, .at_most = 1.0});
    a.Field("speed_spread", speed_spread, {.at_least = 0.0, .at_most = 1.0});
  }
};

/// Follows another real vehicle from where the two come nearest to each other.
struct SwapSpec {
  double within_m = 12.0;  ///< Only vehicles that come so near after the start.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("within_m", within_m, {.above = 0.0, .at_most = 1000.0});
  }
};

/// A claimed vehicle born behind the nearest truck, bus or van ahead of the ego, on the line of
/// sight, which after a while comes out of its shadow.
struct BehindSpec {
  double gap_m = 5.0;       ///< Behind the occluder's centre, half its length on top.
  double hold_s = 3.0;      ///< Stays there so long, relative to the occluder.
  double across_mps = 3.0;  ///< Then sideways to the line of sight.
  double for_m = 15.0;      ///< So far, and stays there.
  double semi_major_m = 0.5;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("gap_m", gap_m, {.at_least = 0.0, .at_most = 100.0});
    a.Field("hold_s", hold_s, {.at_least = 0.0, .at_most = 1e4});
    a.Field("across_mps", across_mps, {.at_least = -30.0, .at_most = 30.0});
    a.Field("for_m", for_m, {.at_least = 0.0, .at_most = 1e4});
    a.Field("semi_major_m", semi_major_m, {.at_least = 0.0, .at_most = 12.7});
  }
};

/// Messages by the thousand, from devices only; `change` does not apply. They have no TRUTH_BSM.
struct FloodSpec {
  enum class Content {
    kRandom,     ///< A new id and a new place within `radius_m` of the ego each time.
    kMalformed,  ///< Values that J2735 does not have, and messages cut short.
  };
  double per_s = 5000.0;
  Content content = Content::kRandom;
  double radius_m = 300.0;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("per_s", per_s, {.above = 0.0, .at_most = 1e5});
    a.Choice("content", content,
             {{"random", Content::kRandom}, {"malformed", Content::kMalformed}});
    a.Field("radius_m", radius_m, {.above = 0.0, .at_most = 1e5});
  }
};

/// Whose motion is claimed. Nothing given: the transmitter's own (devices: the ego's); else one of
/// them.
struct PathSpec {
  std::optional<GhostSpec> ghost;
  std::optional<ShadowSpec> shadow;
  std::optional<GridSpec> grid;
  std::optional<SwapSpec> swap;
  std::optional<BehindSpec> behind;
  std::optional<FloodSpec> flood;
  bool beside_own = false;  ///< A vehicle goes on sending its own honest messages besides.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("ghost", ghost);
    a.Field("shadow", shadow);
    a.Field("grid", grid);
    a.Field("swap", swap);
    a.Field("behind", behind);
    a.Field("flood", flood);
    a.Field("beside_own", beside_own);
  }
};

/// One attack, or an honest oddity made of the same blocks.
struct AttackSpec {
  enum class Kind {
    kAttack,   ///< The transmitters are attackers.
    kSpoofed,  ///< What they say is shaped by an attack on them (GNSS spoofing); they are honest.
    kHonest,   ///< Nobody lies.
  };
  std::string name;  ///< Told in TRUTH_BSM; empty = the overlay's name, or the scenario's.
  Kind kind = Kind::kAttack;
  WhoSpec who;
  WhenSpec when;
  PathSpec path;
  std::vector<ChangeSpec> change;

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Choice("kind", kind,
             {{"attack", Kind::kAttack}, {"spoofed", Kind::kSpoofed}, {"honest", Kind::kHonest}});
    a.Field("who", who);
    a.Field("when", when);
    a.Field("path", path);
    a.Field("change", change);
  }
};

/// Faults that no single key can tell, one problem each, with `where` in front.
void CheckAttack(const AttackSpec& attack, const std::string& where,
                 std::vector<std::string>& problems);

}  // namespace v2vouch::sim
