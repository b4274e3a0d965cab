// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/radar.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/radar_output.h"
#include "sim/sensors/subject.h"
#include "sim/sensors/usual_reflections.h"

namespace v2vouch::sim {
namespace {

constexpr double kRay_rad = FromDegrees(0.1);
constexpr double kWeakest_dbsm = -10.0;

double RangeFactor(double range_m, double max_range_m) {
  if (range_m > max_range_m) return 0.0;
  const double share = range_m / max_range_m;
  return share < 0.7 ? 1.0 : 1.0 - 0.4 * (share - 0.7) / 0.3;
}

}  // namespace

RadarSimulator::RadarSimulator(const World& world, int index, std::uint64_t seed)
    : world_(world),
      radar_(world.vehicle().radars[static_cast<std::size_t>(index)]),
      index_(static_cast<std::uint64_t>(index)),
      seed_(seed),
      skyline_(radar_.half_fov_rad, kRay_rad),
      scenery_(SceneryOf(world)) {
  radar_.detection_probability *= world.scenario().sensors.detection_scale;
  if (const auto& family = world.scenario().family) {
    family_.emplace(family->radar, world.scenario().sensors.noise_scale, index_, seed_);
  }
}

RadarSimulator::Antenna RadarSimulator::AntennaAt(const EgoTruth& ego) const {
  const Vec2 place = ego.PointAt(radar_.x_m, radar_.y_m);
  return {place, ego.VelocityAt(place), ego.yaw_rad + radar_.yaw_rad};
}

void RadarSimulator::Look(const Snapshot& snapshot, std::vector<Sight>& sights) {
  const Antenna antenna = AntennaAt(snapshot.ego);
  skyline_.Cast(antenna.place, antenna.yaw_rad, radar_.max_range_m + 20.0, snapshot,
                world_.walls());
  const std::size_t n = snapshot.actors.size();
  std::vector<int> covered(n, 0);
  if (open_rays_.size() < n) open_rays_.resize(n);
  for (auto& rays : open_rays_) rays.clear();
  std::vector<double> nearest(n, 1e9);
  for (int ray = 0; ray < skyline_.size(); ++ray) {
    const auto& hits = skyline_.hits(ray);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const auto object = static_cast<std::size_t>(hits[i].object);
      if (object >= n) continue;
      ++covered[object];
      if (i == 0 && hits[i].range_m <= radar_.max_range_m) {
        open_rays_[object].push_back(ray);
        nearest[object] = std::min(nearest[object], hits[i].range_m);
      }
    }
  }
  const bool ideal = world_.scenario().sensors.mode == SensorMode::kIdealPoints;
  sights.assign(n, {});
  for (std::size_t i = 0; i < n; ++i) {
    if (open_rays_[i].empty()) continue;
    Sight& sight = sights[i];
    sight.visible_fraction = static_cast<double>(open_rays_[i].size()) / covered[i];
    if (ideal) {
      const Vec2 d = snapshot.actors[i].motion.centre - antenna.place;
      const double azimuth = AngleDifference(std::atan2(d.y(), d.x()), antenna.yaw_rad);
      const bool within = std::abs(azimuth) < radar_.half_fov_rad &&
                          d.norm() < radar_.max_range_m && d.norm() > radar_.min_range_m;
      if (within && sight.visible_fraction >= 0.5) {
        sight.detection_probability = radar_.detection_probability;
      }
    } else {
      sight.detection_probability = radar_.detection_probability *
                                    RangeFactor(nearest[i], radar_.max_range_m) *
                                    std::min(1.0, sight.visible_fraction / 0.2);
    }
  }
}

bool RadarSimulator::AddPoint(const Antenna& antenna, const Vec2& place, const Vec2& velocity,
                              double rcs_dbsm, int track_id, Random& random,
                              radar_scan_t& scan) const {
  const Vec2 d = place - antenna.place;
  const double range = d.norm();
  const double azimuth = AngleDifference(std::atan2(d.y(), d.x()), antenna.yaw_rad);
  if (!Covers(radar_, range, azimuth)) return false;
  const double scale = world_.scenario().sensors.noise_scale;
  const double measured = range + random.Normal(0.0, scale * radar_.range_sigma_m);
  const double bearing = azimuth + random.Normal(0.0, scale * radar_.azimuth_sigma_rad);
  const double rate = (velocity - antenna.velocity).dot(d) / range +
                      random.Normal(0.0, scale * radar_.range_rate_sigma_mps);
  radar_detection_t detection = Reported(radar_, std::max(0.05, measured), bearing, rate);
  // Swerling-like fading; the sensor's own threshold is behind it, so nothing comes out weaker.
  detection.rcs_dbsm = std::max(kWeakest_dbsm, rcs_dbsm + random.Normal(0.0, 3.0));
  detection.snr_db =
      std::clamp(12.0 + (detection.rcs_dbsm - 10.0) + 40.0 * std::log10(radar_.max_range_m / range),
                 6.5, 70.0);
  detection.track_id = track_id;
  scan.detections.push_back(detection);
  return true;
}

void RadarSimulator::AddVehicles(const Snapshot& snapshot, std::int64_t seq, const Antenna& antenna,
                                 radar_scan_t& scan) {
  const bool ideal = world_.scenario().sensors.mode == SensorMode::kIdealPoints;
  const bool objects = radar_.output == RadarOutput::kObjects;
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const ActorState& actor = snapshot.actors[i];
    if (sights_[i].detection_probability <= 0.0) continue;
    Random random = SubjectRandom(seed_, "radar vehicle",
                                  {index_, static_cast<std::uint64_t>(seq), actor.actor->id});
    if (!random.Bernoulli(sights_[i].detection_probability)) continue;
    const double rcs = UsualRcs(actor.actor->object_class);
    if (ideal) {
      AddPoint(antenna, actor.motion.centre, actor.motion.velocity, rcs, -1, random, scan);
      continue;
    }
    // Points on the visible faces: where rays meet this vehicle first.
    const std::vector<int>& rays = open_rays_[i];
    double nearest = radar_.max_range_m;
    for (const int ray : rays) nearest = std::min(nearest, skyline_.hits(ray).front().range_m);
    const auto any_face_point = [&]() -> Vec2 {
      const auto pick =
          static_cast<std::size_t>(random.Uniform() * static_cast<double>(rays.size()));
      const int ray = rays[std::min(pick, rays.size() - 1)];
      return antenna.place + skyline_.hits(ray).front().range_m *
                                 Direction(antenna.yaw_rad + skyline_.azimuth_rad(ray));
    };
    std::vector<Spot> spots = StrongSpots(actor.box(), antenna.place);
    std::erase_if(spots, [&](const Spot& spot) {
      const Vec2 d = spot.place - antenna.place;
      const double azimuth = AngleDifference(std::atan2(d.y(), d.x()), antenna.yaw_rad);
      return d.norm() > skyline_.FreeRange(azimuth) + 0.7;  // Behind something else.
    });
    const double mean = objects ? 1.0 : MeanReflections(actor.actor->object_class, nearest);
    const int count =
        1 + random.Poisson((mean - 1.0) * std::clamp(sights_[i].visible_fraction / 0.6, 0.2, 1.0));
    for (int k = 0; k < count; ++k) {
      Vec2 place = any_face_point();
      double total = 0.0;
      for (const Spot& spot : spots) total += spot.weight;
      if (total > 0.0 && random.Bernoulli(0.8)) {
        double draw = random.Uniform(0.0, total);
        std::size_t chosen = 0;
        while (chosen + 1 < spots.size() && draw >= spots[chosen].weight) {
          draw -= spots[chosen++].weight;
        }
        place = spots[chosen].place;
        spots.erase(spots.begin() + static_cast<std::ptrdiff_t>(chosen));
      }
      const int track_id = objects ? static_cast<int>(actor.actor->id) : -1;
      AddPoint(antenna, place, actor.VelocityAt(place), rcs - 4.0, track_id, random, scan);
    }
  }
}

void RadarSimulator::AddStatics(std::int64_t seq, const Antenna& antenna, radar_scan_t& scan) {
  if (radar_.output == RadarOutput::kObjects) return;
  Random random = SubjectRandom(seed_, "radar scenery", {index_, static_cast<std::uint64_t>(seq)});
  for (const Scatterer& scatterer : scenery_.scatterers) {
    const Vec2 d = scatterer.place - antenna.place;
    if (d.squaredNorm() > radar_.max_range_m * radar_.max_range_m) continue;
    if (!scatterer.normal.isZero() && scatterer.normal.dot(d) >= 0.0) continue;
    const double azimuth = AngleDifference(std::atan2(d.y(), d.x()), antenna.yaw_rad);
    if (std::abs(azimuth) > radar_.half_fov_rad) continue;
    if (d.norm() > skyline_.FreeRange(azimuth) + 0.5) continue;
    if (!random.Bernoulli(scatterer.probability * RangeFactor(d.norm(), radar_.max_range_m))) {
      continue;
    }
    AddPoint(antenna, scatterer.place, Vec2::Zero(), scatterer.rcs_dbsm, -1, random, scan);
  }
}

void RadarSimulator::AddGhosts(const Snapshot& snapshot, std::int64_t seq, const Antenna& antenna,
                               radar_scan_t& scan) {
  constexpr double kReach_m = 60.0;
  constexpr double kSpell_s = 0.3;  // A mirror geometry lasts; ghosts come in short spells.
  const double scale = world_.scenario().sensors.ghost_scale;
  const auto spell = static_cast<std::uint64_t>(snapshot.time_s / kSpell_s);
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    const ActorState& actor = snapshot.actors[i];
    const double range = (actor.motion.centre - antenna.place).norm();
    if (sights_[i].detection_probability <= 0.0 || range > kReach_m) continue;
    Random random = SubjectRandom(seed_, "radar ghost",
                                  {index_, static_cast<std::uint64_t>(seq), actor.actor->id});
    const double rcs = UsualRcs(actor.actor->object_class);
    if (range < 20.0 && random.Bernoulli(std::min(1.0, 0.03 * scale))) {
      // There and back twice: double range, double Doppler, same direction.
      const Vec2 nearest = antenna.place + 0.9 * (actor.motion.centre - antenna.place);
      AddPoint(antenna, antenna.place + 2.0 * (nearest - antenna.place),
               2.0 * actor.motion.velocity - antenna.velocity, rcs - 15.0, -1, random, scan);
    }
    const bool in_spell =
        SubjectRandom(seed_, "radar ghost spell", {index_, spell, actor.actor->id})
            .Bernoulli(std::min(1.0, 0.08 * scale));
    if (!in_spell || actor.motion.speed_mps < 2.0 || !random.Bernoulli(0.5)) continue;
    for (const auto& [a, b] : scenery_.mirrors) {
      const Vec2 image = Mirrored(actor.motion.centre, a, b);
      const Vec2 d = image - antenna.place;
      const double length = d.norm();
      if (length > kReach_m) continue;
      const auto bounce = RayHitsSegment(antenna.place, d / length, a, b);
      if (!bounce || *bounce >= length) continue;
      // The way to the mirror must be free.
      const double azimuth = AngleDifference(std::atan2(d.y(), d.x()), antenna.yaw_rad);
      if (*bounce > skyline_.FreeRange(azimuth) + 0.5) continue;
      const Vec2 velocity = Mirrored(a + actor.motion.velocity, a, b) - a;
      AddPoint(antenna, image, velocity, rcs - 10.0, -1, random, scan);
      break;
    }
  }
}

void RadarSimulator::AddClutter(std::int64_t seq, const Antenna& antenna, radar_scan_t& scan) {
  Random random = SubjectRandom(seed_, "radar clutter", {index_, static_cast<std::uint64_t>(seq)});
  // SNR of noise peaks is 4 dB plus an exponential of 3 dB; the configured rate counts those above
  // the usual 6 dB threshold, so weaker ones come on top.
  constexpr double kFloor_db = 4.0;
  constexpr double kMean_db = 3.0;
  const double rate = radar_.clutter_per_scan * world_.scenario().sensors.clutter_scale *
                      std::exp((6.0 - kFloor_db) / kMean_db);
  const int count = random.Poisson(std::min(rate, 40.0));
  for (int i = 0; i < count; ++i) {
    const double range = random.Uniform(std::max(1.0, radar_.min_range_m), radar_.max_range_m);
    const double bearing = random.Uniform(-radar_.half_fov_rad, radar_.half_fov_rad);
    // Half of it stands (road surface, manholes), the rest has any Doppler.
    const Vec2 direction = Direction(antenna.yaw_rad + bearing);
    const double rate_mps = random.Bernoulli(0.5)
                                ? -antenna.velocity.dot(direction) + random.Normal(0.0, 0.1)
                                : random.Uniform(-30.0, 30.0);
    radar_detection_t detection = Reported(radar_, range, bearing, rate_mps);
    detection.rcs_dbsm = random.Uniform(kWeakest_dbsm, 0.0);
    detection.snr_db = kFloor_db - kMean_db * std::log(1.0 - random.Uniform());
    scan.detections.push_back(detection);
  }
}

void RadarSimulator::Scan(const Snapshot& snapshot, std::int64_t seq, radar_scan_t& scan) {
  const Antenna antenna = AntennaAt(snapshot.ego);
  scan.seq = seq;
  scan.sensor = radar_.name;
  scan.detections.clear();
  Look(snapshot, sights_);
  if (family_) {
    family_->Scan(snapshot, seq,
                  {radar_, antenna.place, antenna.velocity, antenna.yaw_rad, skyline_, open_rays_,
                   scenery_.scatterers, scenery_.mirrors},
                  scan);
    if (world_.scenario().sensors.outlier_share > 0.0) Spoil(seq, scan);
    scan.num_detections = static_cast<std::int32_t>(scan.detections.size());
    return;
  }
  AddVehicles(snapshot, seq, antenna, scan);
  const SensorsSpec& sensors = world_.scenario().sensors;
  const bool realistic = sensors.mode == SensorMode::kRealistic;
  if (realistic || sensors.static_returns) AddStatics(seq, antenna, scan);
  if (realistic) {
    AddGhosts(snapshot, seq, antenna, scan);
    AddClutter(seq, antenna, scan);
  }
  if (sensors.outlier_share > 0.0) Spoil(seq, scan);
  scan.num_detections = static_cast<std::int32_t>(scan.detections.size());
}

void RadarSimulator::Spoil(std::int64_t seq, radar_scan_t& scan) const {
  Random random = SubjectRandom(seed_, "radar outlier", {index_, static_cast<std::uint64_t>(seq)});
  for (radar_detection_t& detection : scan.detections) {
    if (!random.Bernoulli(world_.scenario().sensors.outlier_share)) continue;
    const double by = kOutlierSigmas * random.Uniform(-1.0, 1.0);
    const double which = random.Uniform();
    if (which < 1.0 / 3.0) {
      detection.range_m = std::max(0.1, detection.range_m + by * radar_.range_sigma_m);
    } else if (which < 2.0 / 3.0) {
      detection.azimuth_rad = WrapAngle(detection.azimuth_rad + by * radar_.azimuth_sigma_rad);
    } else {
      detection.range_rate_mps += by * radar_.range_rate_sigma_mps;
    }
  }
}

}  // namespace v2vouch::sim
