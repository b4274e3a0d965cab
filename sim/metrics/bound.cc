// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/bound.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>

#include "sim/metrics/extended_filter.h"
#include "sim/metrics/information_filter.h"
#include "sim/metrics/sight.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kForgetLooks_s = 1.0;  // A lone look counts no longer than this.
constexpr double kFresh_s = 1.0;        // A sender heard this recently is being heard.
constexpr double kSeen_s = 0.3;         // A vehicle looked at this recently is being seen.

/// Own-sensor frames in order of arrival; the nominal periods where the log holds none.
std::vector<SensorLook> Looks(const RunLog& log) {
  if (!log.looks.empty()) return log.looks;
  std::vector<SensorLook> looks;
  for (std::size_t s = 0; s < log.specs.sensors.size(); ++s) {
    const Duration period = FromSeconds(log.specs.sensors[s].period_s);
    for (Timestamp t = log.truth.begin(); t <= log.truth.end(); t += period) {
      looks.push_back({t, t, s});
    }
  }
  std::sort(looks.begin(), looks.end(), [](const SensorLook& a, const SensorLook& b) {
    return std::pair(a.received, a.sensor) < std::pair(b.received, b.sensor);
  });
  return looks;
}

InformationFilter::Manoeuvre RealisedManoeuvre(const TruthObject& object,
                                               const BoundSettings& settings) {
  double along = 0.0;
  double across = 0.0;
  for (const TruthSample& sample : object.motion.samples()) {
    const double lateral = sample.motion.speed_mps * sample.motion.yaw_rate_radps;
    along += sample.motion.accel_mps2 * sample.motion.accel_mps2;
    across += lateral * lateral;
  }
  const double count = std::max<double>(1.0, static_cast<double>(object.motion.samples().size()));
  return {std::max(settings.least_along_mps2, std::sqrt(along / count)),
          std::max(settings.least_across_mps2, std::sqrt(across / count)), settings.singer_time_s};
}

/// One vehicle's walk along the grid.
class Walk {
 public:
  Walk(const RunLog& log, const TruthObject& object, const BoundSettings& settings)
      : log_(log),
        object_(object),
        settings_(settings),
        local_(RealisedManoeuvre(object, settings), log.specs.sender),
        extended_(RealisedManoeuvre(object, settings), SizePriorOf(object.object_class)),
        fused_(local_),
        heard_(local_) {
    for (const TruthSample& sample : object.motion.samples()) {
      if (sample.sender != 0) senders_.insert(sample.sender);
    }
  }

  void Look(const SensorLook& look) {
    const TruthSample* sample = object_.motion.InForce(look.stamp);
    const auto target = object_.motion.At(look.stamp);
    const auto ego = log_.truth.ego.At(look.stamp);
    if (sample == nullptr || !target || !ego) return;
    const SensorSpec& sensor = log_.specs.sensors[look.sensor];
    const double p = DetectionProbability(*sample, sensor);
    if (p <= 0.0) return;
    local_.AddSensor(sensor, *ego, *target, p);
    extended_.AddSensor(sensor, *ego, *target, object_.length_m, object_.width_m, p);
    fused_.AddSensor(sensor, *ego, *target, p);
    looks_ += p;
    // A standing radar return starts no LOCAL track by itself: it may be a post.
    if (sensor.kind != SensorKind::kRadar || std::abs(target->speed_mps) >= settings_.moving_mps) {
      starting_looks_ += p;
      last_starting_ = look.received;
    }
    last_look_ = look.received;
    if (p >= kSeeing) last_seen_ = look.received;
  }

  void Hear(const BsmArrival& bsm) {
    if (!senders_.contains(bsm.sender)) return;
    const auto target = object_.motion.At(bsm.received);
    if (!target) return;
    fused_.AddBsm(*target);
    heard_.AddBsm(*target);
    if (!first_heard_) first_heard_ = bsm.received;
    last_heard_ = bsm.received;
    ++messages_;
  }

  /// Ends one step of the grid at `t`. Fills the three lists' cells.
  void Finish(Timestamp t, double dt_s, std::array<BoundCell*, 3> cells) {
    const auto target = object_.motion.At(t);
    if (!target) {
      if (is_present_) Restart();
      is_present_ = false;
      return;
    }
    is_present_ = true;
    for (auto* filter : {&local_, &fused_, &heard_}) filter->Apply();
    extended_.Apply();
    FinishLocal(t, *cells[Index(ListKind::kLocal)]);
    FinishPriority(t, dt_s, *cells[Index(ListKind::kPriority)]);
    FinishV2v(*cells[Index(ListKind::kV2v)]);
    // For the next step; the filters stand at `t` when its cells are read.
    pending_yaw_rad_ = target->yaw_rad;
  }

  void Advance(double dt_s) {
    if (!is_present_) return;
    for (auto* filter : {&local_, &fused_, &heard_}) filter->Predict(dt_s, pending_yaw_rad_);
    extended_.Predict(dt_s, pending_yaw_rad_);
  }

 private:
  [[nodiscard]] bool WorthKeeping(const InformationFilter& filter) const {
    const double c = settings_.drop_cutoff_m;
    return TruncatedSquare(filter.position_variance_m2(), c) < 0.5 * c * c;
  }

  static bool Within(const std::optional<Timestamp>& last, Timestamp t, double seconds) {
    return last && ToSeconds(t - *last) <= seconds;
  }

  void FinishLocal(Timestamp t, BoundCell& cell) {
    if (!is_plain_ && !Within(last_look_, t, kForgetLooks_s)) looks_ = 0.0;
    if (!is_local_ && !Within(last_starting_, t, kForgetLooks_s)) starting_looks_ = 0.0;
    is_plain_ |= looks_ >= settings_.looks_to_confirm;
    if (!is_local_ && starting_looks_ >= settings_.looks_to_confirm) {
      is_local_ = true;
      confirmed_ = t;
    }
    if (is_plain_ && !WorthKeeping(local_)) {
      is_local_ = is_plain_ = false;
      looks_ = starting_looks_ = 0.0;
      local_.Reset();
      extended_.Reset();
    }
    cell.is_held = is_local_;
    cell.is_held_plain = is_plain_;
    cell.variance_m2 = local_.position_variance_m2();
    cell.extended_variance_m2 = extended_.position_variance_m2();
  }

  void FinishPriority(Timestamp t, double dt_s, BoundCell& cell) {
    if (is_local_ && !is_known_) {
      is_known_ = true;
      known_since_ = *confirmed_;
      co_observed_s_ = 0.0;
    }
    if (is_known_) {
      const bool is_seen = Within(last_seen_, t, kSeen_s);
      if (is_seen && Within(last_heard_, t, kFresh_s)) co_observed_s_ += dt_s;
      const double budget =
          std::min(settings_.bridge_most_s,
                   std::max(settings_.bridge_least_s, settings_.bridge_base_s + co_observed_s_));
      const bool has_begun = cell_begun_;
      const bool may_stay =
          Within(last_look_, t, budget) && WorthKeeping(fused_) && (has_begun || is_local_);
      if (!may_stay) {
        is_known_ = false;
        cell_begun_ = false;
        // What the radio said stays known, but the bound is for a list that has to vouch anew.
      }
    }
    if (!is_known_ || !first_heard_) return;
    const Timestamp ready = std::max(*first_heard_, known_since_);
    cell.is_held_plain = t >= ready;
    cell.is_held = t >= ready + FromSeconds(settings_.validation_s);
    cell_begun_ = cell_begun_ || cell.is_held_plain;
    cell.variance_m2 = fused_.position_variance_m2();
  }

  void FinishV2v(BoundCell& cell) {
    cell.is_held = messages_ >= 2 && WorthKeeping(heard_);
    cell.is_held_plain = cell.is_held;
    cell.variance_m2 = heard_.position_variance_m2();
  }

  void Restart() {
    for (auto* filter : {&local_, &fused_, &heard_}) filter->Reset();
    extended_.Reset();
    looks_ = starting_looks_ = 0.0;
    messages_ = 0;
    is_plain_ = is_local_ = is_known_ = cell_begun_ = false;
    first_heard_ = last_heard_ = last_look_ = last_seen_ = confirmed_ = std::nullopt;
    last_starting_ = std::nullopt;
  }

  const RunLog& log_;
  const TruthObject& object_;
  const BoundSettings& settings_;
  InformationFilter local_;
  ExtendedFilter extended_;
  InformationFilter fused_, heard_;
  std::set<std::uint32_t> senders_;
  bool is_present_ = false;
  double pending_yaw_rad_ = 0.0;
  double looks_ = 0.0;
  double starting_looks_ = 0.0;  // Of these, the ones that may start a LOCAL track.
  int messages_ = 0;
  std::optional<Timestamp> last_starting_;
  std::optional<Timestamp> last_look_, last_seen_, first_heard_, last_heard_, confirmed_;
  bool is_plain_ = false;    // Looked at twice, by whatever sensor.
  bool is_local_ = false;    // Looked at twice in a way that may start a track.
  bool is_known_ = false;    // Confirmed by own sensors and not given up since.
  bool cell_begun_ = false;  // Was matched to its sender since.
  Timestamp known_since_{};
  double co_observed_s_ = 0.0;
};

}  // namespace

Bound::Bound(const RunLog& log, const std::vector<Timestamp>& grid, const BoundSettings& settings)
    : instants_(grid.size()) {
  const std::size_t objects = log.truth.objects.size();
  for (auto& cells : cells_) cells.resize(objects * instants_);
  const std::vector<SensorLook> looks = Looks(log);
  for (std::size_t o = 0; o < objects; ++o) {
    if (!log.truth.objects[o].is_vehicle()) continue;
    if (settings.only_senders && !log.truth.objects[o].has_v2v) continue;
    Walk walk(log, log.truth.objects[o], settings);
    std::size_t look = 0;
    std::size_t bsm = 0;
    for (std::size_t k = 0; k < instants_; ++k) {
      const double dt_s = k == 0 ? 0.0 : ToSeconds(grid[k] - grid[k - 1]);
      if (k > 0) walk.Advance(dt_s);
      for (; look < looks.size() && looks[look].received <= grid[k]; ++look) {
        walk.Look(looks[look]);
      }
      for (; bsm < log.bsms.size() && log.bsms[bsm].received <= grid[k]; ++bsm) {
        walk.Hear(log.bsms[bsm]);
      }
      const std::size_t cell = o * instants_ + k;
      walk.Finish(grid[k], dt_s, {&cells_[0][cell], &cells_[1][cell], &cells_[2][cell]});
    }
  }
}

}  // namespace v2vouch::evaluation
