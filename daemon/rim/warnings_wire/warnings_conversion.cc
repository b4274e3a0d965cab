// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/warnings_wire/warnings_conversion.h"

#include <algorithm>
#include <cmath>

namespace v2vouch::wire {
namespace {

bool IsUsable(const track_t& track) {
  const auto is_sound = [](double v) { return std::isfinite(v) && std::abs(v) < 1e9; };
  const double figures[] = {track.x_odom_m,  track.y_odom_m,       track.yaw_odom_rad,
                            track.speed_mps, track.yaw_rate_radps, track.accel_mps2,
                            track.length_m,  track.width_m,        track.existence};
  return std::ranges::all_of(figures, is_sound) &&
         std::ranges::all_of(track.covariance_odom, is_sound);
}

warnings::Target ToTarget(const track_t& track, const track_list_t& list, ListOrigin origin) {
  warnings::Target out;
  const bool is_local = origin == ListOrigin::kLocal;
  out.source = is_local ? warnings::Source::kLocal : warnings::Source::kPriority;
  out.track_id = is_local ? 0 : track.id;
  out.local_id = is_local ? track.id : track.local_id;
  out.state_O.mean << track.x_odom_m, track.y_odom_m, track.yaw_odom_rad, track.speed_mps,
      track.yaw_rate_radps, track.accel_mps2;
  out.state_O.covariance =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(track.covariance_odom);
  out.extent = {std::clamp(track.length_m, 0.3, 30.0), std::clamp(track.width_m, 0.3, 4.0),
                track.length_sigma_m, track.width_sigma_m};
  if (track.object_class >= 0 && track.object_class <= 7) {
    out.object_class = static_cast<ObjectClass>(track.object_class);
  }
  out.existence = std::clamp(track.existence, 0.0, 1.0);
  if (track.visibility >= 0 && track.visibility <= 2) {
    out.visibility = static_cast<Visibility>(track.visibility);
  }
  out.says_hard_braking =
      origin == ListOrigin::kPriority && (track.events & track_t::EVENT_HARD_BRAKING) != 0;
  out.bridge_budget_s = is_local ? kNaN : track.bridge_budget_s;
  for (const track_source_t& source : track.sources) {
    if (source.kind == track_source_t::V2V) continue;
    out.last_own = std::max(out.last_own, FromMicros(source.last_utime));
  }
  if (origin == ListOrigin::kUnverified) {
    out.local_id = 0;
    out.existence = 1.0;
    out.visibility = Visibility::kVisible;
    out.last_own = FromMicros(list.utime);
  }
  return out;
}

}  // namespace

warnings::TargetList ToTargets(const track_list_t& list, ListOrigin origin) {
  warnings::TargetList out;
  out.stamp = FromMicros(list.utime);
  out.seq = list.seq;
  out.is_stale = list.stale != 0;
  out.is_gnss_suspect = list.ego_gnss_suspect != 0;
  out.ego_p_O = {list.ego_x_odom_m, list.ego_y_odom_m};
  out.ego_yaw_O = list.ego_yaw_odom_rad;
  for (const sector_health_t& sector : list.sectors) {
    if (!std::isfinite(sector.from_rad + sector.to_rad) || std::isnan(sector.range_m)) continue;
    const auto state = sector.state == 0   ? SectorState::kWatched
                       : sector.state == 1 ? SectorState::kDegraded
                                           : SectorState::kBlind;
    out.sectors.push_back({sector.from_rad, sector.to_rad, sector.range_m, state});
  }
  for (const track_t& track : list.tracks) {
    if (track.is_confirmed == 0 && origin != ListOrigin::kUnverified) continue;
    if (IsUsable(track)) out.targets.push_back(ToTarget(track, list, origin));
  }
  return out;
}

std::optional<warnings::EgoReading> ToEgoReading(const ego_motion_t& motion) {
  if (motion.utime <= 0 || !(std::abs(motion.speed_mps) <= 120.0)) return std::nullopt;
  warnings::EgoReading out;
  out.stamp = FromMicros(motion.utime);
  out.speed_mps = motion.speed_mps;
  const auto is_within = [](double v, double most) { return std::abs(v) <= most; };
  if (motion.speed_sigma_mps > 0.0 && motion.speed_sigma_mps <= 1000.0) {
    out.speed_sigma_mps = motion.speed_sigma_mps;
  }
  if (is_within(motion.yaw_rate_radps, 10.0)) out.yaw_rate_radps = motion.yaw_rate_radps;
  if (motion.yaw_rate_sigma_radps > 0.0 && motion.yaw_rate_sigma_radps <= 1000.0) {
    out.yaw_rate_sigma_radps = motion.yaw_rate_sigma_radps;
  }
  if (is_within(motion.accel_long_mps2, 100.0)) out.accel_mps2 = motion.accel_long_mps2;
  return out;
}

warnings::EgoIntent ToIntent(const ego_intent_t& intent) {
  warnings::EgoIntent out;
  out.stamp = FromMicros(intent.utime);
  if (intent.turn_signal >= 0 && intent.turn_signal <= 2) {
    out.turn_signal = static_cast<warnings::TurnSignal>(intent.turn_signal);
  }
  out.is_braking = intent.brake == 1;
  if (std::abs(intent.accel_request_mps2) <= 100.0) {
    out.accel_request_mps2 = intent.accel_request_mps2;
  }
  for (const path_point_t& point : intent.points) {
    const Eigen::Vector2d p(point.x_body_m, point.y_body_m);
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e4) {
      out.path_B.clear();
      break;
    }
    out.path_B.push_back(p);
  }
  if (out.path_B.size() < 2) out.path_B.clear();
  return out;
}

warning_list_t ToMessage(const warnings::WarningList& list) {
  warning_list_t out{};
  out.utime = ToMicros(list.stamp);
  out.seq = list.seq;
  out.local_seq = list.local_seq;
  out.priority_seq = list.priority_seq;
  out.available_kinds = list.available_kinds;
  out.unavailable_kinds = warnings::kAllKinds & ~list.available_kinds;
  out.degraded = list.degraded;
  for (const warnings::Warning& warning : list.warnings) {
    const warnings::Figures& figures = warning.figures;
    warning_t w{};
    w.track_id = warning.track_id;
    w.local_id = warning.local_id;
    w.kind = static_cast<std::int8_t>(warning.kind);
    w.level = static_cast<std::int8_t>(warning.level);
    w.side = static_cast<std::int8_t>(warning.side);
    w.source = static_cast<std::int8_t>(warning.source);
    w.visibility = static_cast<std::int8_t>(warning.visibility);
    w.basis = static_cast<std::int8_t>(warning.basis);
    w.since_utime = ToMicros(warning.since);
    w.conflict_probability = figures.conflict_probability;
    w.time_to_conflict_s = figures.time_to_conflict_s;
    w.time_to_conflict_early_s = figures.time_to_conflict_early_s;
    w.post_encroachment_s = figures.post_encroachment_s;
    w.required_decel_mps2 = figures.required_decel_mps2;
    w.warn_before_s = figures.warn_before_s;
    w.urgent_before_s = figures.urgent_before_s;
    w.conflict_x_body_m = figures.conflict_B.x();
    w.conflict_y_body_m = figures.conflict_B.y();
    w.x_body_m = figures.position_B.x();
    w.y_body_m = figures.position_B.y();
    w.speed_mps = figures.speed_mps;
    w.existence = figures.existence;
    w.own_sensor_age_s = figures.own_sensor_age_s;
    w.bridge_budget_s = figures.bridge_budget_s;
    out.warnings.push_back(w);
  }
  out.num_warnings = static_cast<std::int32_t>(out.warnings.size());
  return out;
}

}  // namespace v2vouch::wire
