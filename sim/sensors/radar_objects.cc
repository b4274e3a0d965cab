// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/radar_objects.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/radar_output.h"

namespace v2vouch::sim {

// Another part of the vehicle answers: a corner, the middle of a face, the centre.
void RadarObjects::Renew(double time_s, Random& random, TrackedObject& object) {
  if (time_s >= object.jump_s) {
    const auto part = [&] { return std::floor(random.Uniform(-1.0, 2.0)); };  // -1, 0, 1.
    object.x_share = part();
    object.y_share = part();
    object.jump_s = time_s - spec_.jump_every_s * std::log(1.0 - random.Uniform());
  }
  if (time_s >= object.new_id_s) {
    object.track_id = next_track_id_++;
    object.new_id_s = time_s - spec_.new_id_every_s * std::log(1.0 - random.Uniform());
  }
}

void RadarObjects::ReportObject(const RadarView& view, const TrackedObject& object, Random& random,
                                radar_scan_t& scan) const {
  if (!view.Covers(object.place)) return;
  const RadarConfig& radar = view.radar;
  const Vec2 d = object.place - view.place;
  const double range = d.norm() + random.Normal(0.0, noise_scale_ * radar.range_sigma_m);
  const double azimuth =
      view.AzimuthTo(object.place) + random.Normal(0.0, noise_scale_ * radar.azimuth_sigma_rad);
  const double rate = (object.velocity - view.velocity).dot(d) / d.norm() +
                      random.Normal(0.0, noise_scale_ * radar.range_rate_sigma_mps);
  radar_detection_t detection = Reported(radar, std::max(0.05, range), azimuth, rate);
  detection.rcs_dbsm = 10.0;
  detection.snr_db = 30.0 - 40.0 * std::log10(d.norm() / (2.0 * kReference_m));
  detection.track_id = object.track_id;
  scan.detections.push_back(detection);
}

void RadarObjects::Report(const Snapshot& snapshot, const RadarView& view,
                          const std::function<bool(std::int64_t)>& is_seen, Random& random,
                          radar_scan_t& scan) {
  const double now = snapshot.time_s;
  const double dt = now - last_time_s_;
  for (const ActorState& actor : snapshot.actors) {
    const auto id = static_cast<std::int64_t>(actor.actor->id);
    if (!is_seen(id)) continue;
    const auto [found, is_new] = objects_.try_emplace(id);
    TrackedObject& object = found->second;
    if (is_new) object.seen_since_s = now;
    object.last_seen_s = now;
    Renew(now, random, object);
    const Box box = actor.box();
    object.place =
        box.PointAt(0.5 * box.length_m * object.x_share, 0.5 * box.width_m * object.y_share);
    object.velocity = actor.VelocityAt(object.place);
  }
  if (random.Bernoulli(std::min(1.0, spec_.false_objects_per_s * dt))) {
    TrackedObject& object = objects_[next_false_--];
    const double range = random.Uniform(5.0, std::min(80.0, view.radar.max_range_m));
    const double azimuth = random.Uniform(-view.radar.half_fov_rad, view.radar.half_fov_rad);
    object.place = view.place + range * Direction(view.yaw_rad + azimuth);
    object.velocity = random.Bernoulli(0.5)
                          ? Vec2(Vec2::Zero())
                          : Vec2(random.Uniform(1.0, 15.0) * Direction(random.Uniform(-kPi, kPi)));
    object.seen_since_s = object.last_seen_s = now;
    object.ends_s = now + 0.3 - 1.5 * std::log(1.0 - random.Uniform());
    object.track_id = next_track_id_++;
    object.new_id_s = object.jump_s = 1e9;
  }
  std::erase_if(objects_, [&](const auto& entry) {
    const TrackedObject& object = entry.second;
    return entry.first < 0 ? now > object.ends_s : now - object.last_seen_s > spec_.coast_s;
  });
  for (auto& [id, object] : objects_) {
    const bool coasts = id < 0 || object.last_seen_s < now;
    if (coasts) object.place += dt * object.velocity;
    if (id >= 0 && now - object.seen_since_s < spec_.confirm_s) continue;
    ReportObject(view, object, random, scan);
  }
  last_time_s_ = now;
}

}  // namespace v2vouch::sim
