// SPDX-License-Identifier: Apache-2.0
#include "sim/warnings/warn_log_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <v2vouch/truth_bsm_t.hpp>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/big_endian.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/warnings_wire/warnings_conversion.h"
#include "daemon/rim/wire/codec.h"
#include "sim/run_log/run_log.h"
#include "sim/run_log/why_not_judged.h"

namespace v2vouch::evaluation {
namespace {

using wire::ListOrigin;

StateMatrix TrueCovariance() { return 1e-4 * StateMatrix::Identity(); }

constexpr double kLinger_s = 10.0;  // A lie acts on for so long after its last message.

// One warner per consumer, fed as a bus would.
class Consumers {
 public:
  Consumers(const warnings::WarningsConfig& config, WarnRun& run)
      : run_(run), warners_{{{config, run.body}, {config, run.body}, {config, run.body}}} {}

  void Intent(const warnings::EgoIntent& intent) {
    for (auto& warner : warners_) warner.OnIntent(intent);
  }

  void Take(const LogEvent& event) {
    if (event.channel == "EGO_MOTION") {
      const auto motion = wire::Decode<ego_motion_t>(event.bytes);
      const auto reading = motion ? wire::ToEgoReading(*motion) : std::nullopt;
      if (!reading) return;
      for (auto& warner : warners_) warner.OnEgo(*reading);
      return;
    }
    if (event.channel == "TRUTH_BSM") {
      const auto truth = wire::Decode<truth_bsm_t>(event.bytes);
      if (truth && truth->is_attack != 0) lied_[BigEndian32(truth->sender_id)] = event.received;
      return;
    }
    const bool is_local = event.channel == "TRACKS_LOCAL";
    const bool is_priority = event.channel == "TRACKS_PRIORITY";
    if (!is_local && !is_priority && event.channel != "TRACKS_V2V") return;
    const auto list = wire::Decode<track_list_t>(event.bytes);
    if (!list) return;
    if (!is_local) NoteSenders(*list, is_priority ? Consumer::kOurs : Consumer::kV2v);
    if (is_local) {
      // LOCAL alone gets an empty PRIORITY, so that it answers at the same rate.
      const auto targets = wire::ToTargets(*list, ListOrigin::kLocal);
      At(Consumer::kLocal).OnLocal(targets);
      At(Consumer::kOurs).OnLocal(targets);
      warnings::TargetList nothing = targets;
      nothing.targets.clear();
      Say(Consumer::kLocal, event.received, At(Consumer::kLocal).OnPriority(nothing));
    } else if (is_priority) {
      Say(Consumer::kOurs, event.received,
          At(Consumer::kOurs).OnPriority(wire::ToTargets(*list, ListOrigin::kPriority)));
    } else {
      auto targets = wire::ToTargets(*list, ListOrigin::kUnverified);
      targets.sectors = {{-kPi, kPi - 1e-3, 300.0, SectorState::kWatched}};
      // Taken for true, as published V2V-only programs do: none of them has a covariance.
      for (auto& target : targets.targets) target.state_O.covariance = TrueCovariance();
      Say(Consumer::kV2v, event.received, At(Consumer::kV2v).OnPriority(targets));
    }
  }

 private:
  warnings::Warner& At(Consumer c) { return warners_[static_cast<std::size_t>(c)]; }
  void NoteSenders(const track_list_t& list, Consumer c) {
    auto& senders = senders_[static_cast<std::size_t>(c)];
    for (const track_t& track : list.tracks) senders[track.id] = BigEndian32(track.v2v_id);
  }
  [[nodiscard]] bool IsOfLiar(Consumer c, const warnings::Warning& warning, Timestamp at) const {
    const auto& senders = senders_[static_cast<std::size_t>(c)];
    const auto sender = senders.find(warning.track_id);
    if (warning.track_id == 0 || sender == senders.end()) return false;
    const auto lied = lied_.find(sender->second);
    return lied != lied_.end() && at - lied->second <= FromSeconds(kLinger_s);
  }
  void Say(Consumer c, Timestamp at, std::optional<warnings::WarningList> list) {
    if (!list) return;
    SaidWarnings said{at, std::move(*list)};
    for (const auto& warning : said.list.warnings) {
      said.is_of_liar.push_back(IsOfLiar(c, warning, at));
    }
    run_.said[static_cast<std::size_t>(c)].push_back(std::move(said));
  }

  WarnRun& run_;
  std::array<warnings::Warner, 3> warners_;
  std::array<std::map<std::int64_t, std::uint32_t>, 3> senders_;  // By id of the track.
  std::map<std::uint32_t, Timestamp> lied_;                       // Last lie under each id.
};

warnings::TargetList TruthAt(const Truth& truth, Timestamp t, const PlanarMotion& ego) {
  warnings::TargetList list;
  list.stamp = t;
  list.ego_p_O = ego.position();
  list.ego_yaw_O = ego.yaw_rad;
  list.sectors = {{-kPi, kPi - 1e-3, 300.0, SectorState::kWatched}};
  for (const TruthObject& object : truth.objects) {
    const auto motion = object.motion.At(t);
    if (!motion || !object.is_vehicle()) continue;
    warnings::Target target;
    target.track_id = object.id;
    target.local_id = object.id;
    target.source = warnings::Source::kPriority;
    target.state_O.mean << motion->x_m, motion->y_m, motion->yaw_rad, motion->speed_mps,
        motion->yaw_rate_radps, motion->accel_mps2;
    target.state_O.covariance = TrueCovariance();
    target.extent = {object.length_m, object.width_m, 0.01, 0.01};
    target.last_own = t;
    list.targets.push_back(target);
  }
  return list;
}

void RunOnTruth(const warnings::WarningsConfig& config, WarnRun& run) {
  warnings::Warner warner(config, run.body);
  for (const TruthSample& sample : run.truth.ego.samples()) {
    const Timestamp t = sample.stamp;
    const PlanarMotion& ego = sample.motion;
    warner.OnEgo({t, ego.speed_mps, 0.02, ego.yaw_rate_radps, 0.0005, ego.accel_mps2});
    warner.OnIntent(IntentFromTruth(run.truth, t));
    const auto list = warner.OnPriority(TruthAt(run.truth, t, ego));
    if (list) run.truth_said.push_back({t, *list});
  }
}

}  // namespace

const char* ConsumerKey(Consumer consumer) {
  constexpr std::array<const char*, 3> kKeys = {"v2v", "local", "ours"};
  return kKeys[static_cast<std::size_t>(consumer)];
}

warnings::EgoIntent IntentFromTruth(const Truth& truth, Timestamp t) {
  constexpr double kAhead_m = 17.0;
  const double kTurn_rad = FromDegrees(50.0);
  warnings::EgoIntent intent;
  intent.stamp = t;
  intent.turn_signal = warnings::TurnSignal::kNone;
  const auto& samples = truth.ego.samples();
  const auto begin = std::ranges::lower_bound(samples, t, {}, &TruthSample::stamp);
  if (begin == samples.end()) return intent;
  intent.is_braking = begin->motion.accel_mps2 < -0.5;
  intent.accel_request_mps2 = begin->motion.accel_mps2;
  const double reach_m = kAhead_m + std::max(0.0, begin->motion.speed_mps);
  double gone_m = 0.0;
  for (auto at = begin; at + 1 != samples.end() && gone_m < reach_m; ++at) {
    gone_m += ((at + 1)->motion.position() - at->motion.position()).norm();
    const double turned = WrapAngle((at + 1)->motion.yaw_rad - begin->motion.yaw_rad);
    if (std::abs(turned) < kTurn_rad) continue;
    intent.turn_signal = turned > 0.0 ? warnings::TurnSignal::kLeft : warnings::TurnSignal::kRight;
    break;
  }
  // On until the turn is done.
  double done_m = 0.0;
  for (auto at = begin; intent.turn_signal == warnings::TurnSignal::kNone &&
                        at != samples.begin() && done_m < reach_m;
       --at) {
    done_m += (at->motion.position() - (at - 1)->motion.position()).norm();
    const bool still_turns = std::abs(begin->motion.yaw_rate_radps) > 0.1;
    const double turned = WrapAngle(begin->motion.yaw_rad - (at - 1)->motion.yaw_rad);
    if (!still_turns || std::abs(turned) < FromDegrees(20.0)) continue;
    intent.turn_signal = turned > 0.0 ? warnings::TurnSignal::kLeft : warnings::TurnSignal::kRight;
  }
  return intent;
}

bool RunWarnings(const std::string& path, const warnings::WarningsConfig& config, WarnRun& run,
                 std::string& error) {
  {
    RunLog log;
    if (!ReadRunLog(path, {}, log, error)) return false;
    if (error = WhyNotJudged(log); !error.empty()) return false;
    run.damaged = log.damaged;
    run.scenario = log.specs.name;
    run.truth = std::move(log.truth);
    run.body = {log.specs.ego_length_m, log.specs.ego_width_m, log.specs.ego_centre_x_m};
  }
  run.seconds = ToSeconds(run.truth.end() - run.truth.begin());
  const auto reader = LogReader::Open(path, error);
  if (!reader) return false;
  Consumers consumers(config, run);
  LogEvent event;
  std::optional<Timestamp> intent_at;
  while (reader->Next(event)) {
    if (event.received <= run.truth.end() &&
        (!intent_at || event.received - *intent_at >= Duration(100'000))) {
      intent_at = event.received;
      consumers.Intent(IntentFromTruth(run.truth, event.received));
    }
    consumers.Take(event);
  }
  RunOnTruth(config, run);
  return true;
}

}  // namespace v2vouch::evaluation
