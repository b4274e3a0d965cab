// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/radar_family.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/sensors/radar_output.h"
#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kBehind_m = 0.7;        // A point this far behind the first face is hidden.
constexpr double kHiddenSide_db = 12.0;  // A wheel on the far side, seen under the car.
constexpr double kSpell_s = 0.5;         // Images come and go so.
constexpr double kEdgeLoss_db = 6.0;     // Of the beam, at the edge of the field of view.

double Power(double db) { return std::pow(10.0, 0.1 * db); }
double Decibel(double power) { return 10.0 * std::log10(std::max(power, 1e-12)); }

}  // namespace

double RadarView::AzimuthTo(const Vec2& point) const {
  const Vec2 d = point - place;
  return AngleDifference(std::atan2(d.y(), d.x()), yaw_rad);
}

bool RadarView::Covers(const Vec2& point) const {
  return sim::Covers(radar, (point - place).norm(), AzimuthTo(point));
}

RadarFamily::RadarFamily(const RadarFamilySpec& spec, double noise_scale, std::uint64_t index,
                         std::uint64_t seed)
    : spec_(spec),
      noise_scale_(noise_scale),
      index_(index),
      seed_(seed),
      objects_(spec, noise_scale) {}

void RadarFamily::AddEcho(const RadarView& view, const Vec2& place, const Vec2& velocity,
                          double snr_at_20m_db, std::int64_t vehicle) {
  if (!view.Covers(place)) return;
  const Vec2 d = place - view.place;
  const double range = d.norm();
  const double azimuth = view.AzimuthTo(place);
  const double off = azimuth / view.radar.half_fov_rad;
  const double snr =
      snr_at_20m_db - 40.0 * std::log10(range / kReference_m) - kEdgeLoss_db * off * off;
  echoes_.push_back({range, azimuth, (velocity - view.velocity).dot(d) / range, snr, vehicle});
}

void RadarFamily::AddVehicle(const Snapshot& snapshot, const ActorState& actor, std::size_t index,
                             const RadarView& view, Random& random) {
  const auto id = static_cast<std::int64_t>(actor.actor->id);
  const auto [found, is_new] = points_.try_emplace(id);
  if (is_new) {
    found->second = PointsOf(spec_, actor.actor->object_class, actor.actor->size, id, seed_);
  }
  const std::vector<ReflectionPoint>& points = found->second;
  Fading& fading = fading_[id];
  if (fading.db.size() != points.size()) {
    fading.db.clear();
    for (std::size_t k = 0; k < points.size(); ++k) {
      fading.db.push_back(random.Normal(0.0, spec_.fading_db));
    }
  } else {
    const double rho = std::exp(-(snapshot.time_s - fading.time_s) / spec_.fading_s);
    const double fresh = spec_.fading_db * std::sqrt(std::max(0.0, 1.0 - rho * rho));
    for (double& db : fading.db) db = rho * db + random.Normal(0.0, fresh);
  }
  fading.time_s = snapshot.time_s;
  const Box box = actor.box();
  const std::vector<FacingSide> sides = FacingSides(box, view.place);
  const auto first_at = [&](const Vec2& place) {
    const int ray = view.skyline.RayAt(view.AzimuthTo(place));
    if (ray < 0 || view.skyline.hits(ray).empty()) return -1;
    return view.skyline.hits(ray).front().object;
  };
  const auto is_open = [&](const Vec2& place) {
    return (place - view.place).norm() <= view.skyline.FreeRange(view.AzimuthTo(place)) + kBehind_m;
  };
  for (const FacingSide& side : sides) {
    const Vec2 place = box.PointAt(side.nearest.x(), side.nearest.y());
    const double off = ToDegrees(side.off_normal_rad) / spec_.specular_lobe_deg;
    const double db = spec_.specular_db + ClassGain(actor.actor->object_class) -
                      std::min(30.0, 12.0 * off * off) + random.Normal(0.0, spec_.fluctuation_db);
    if (is_open(place)) AddEcho(view, place, actor.VelocityAt(place), db, id);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ReflectionPoint& point = points[k];
    const Vec2 place = box.PointAt(point.local.x(), point.local.y());
    double db = point.db + fading.db[k] + random.Normal(0.0, spec_.fluctuation_db);
    const double spin = random.Uniform();
    const bool has_spin = random.Bernoulli(spec_.wheel_spin);
    if (point.normals[0].isZero()) {  // Inside: through glass and under the body.
      if (first_at(place) != static_cast<int>(index)) continue;
    } else {
      const bool faces = std::ranges::any_of(sides, [&](const FacingSide& side) {
        return side.normal.dot(point.normals[0]) > 0.5 || side.normal.dot(point.normals[1]) > 0.5;
      });
      if (!faces && !point.is_wheel) continue;
      if (faces ? !is_open(place) : first_at(place) != static_cast<int>(index)) continue;
      if (!faces) db -= kHiddenSide_db;
    }
    Vec2 velocity = actor.VelocityAt(place);
    if (point.is_wheel && has_spin) velocity *= 2.0 * spin;  // From 0 below to 2 v on top.
    AddEcho(view, place, velocity, db, id);
  }
}

void RadarFamily::AddImages(const Snapshot& snapshot, const ActorState& actor,
                            const RadarView& view, Random& random) {
  const Vec2 d = actor.motion.centre - view.place;
  const double range = d.norm();
  if (range > 70.0) return;
  const auto id = static_cast<std::int64_t>(actor.actor->id);
  const double strength = spec_.corner_db + ClassGain(actor.actor->object_class);
  if (random.Bernoulli(spec_.under_body)) {  // Road, floor, road again: later than the rear.
    const double later = random.Uniform(0.3, 0.5 * actor.actor->size.length_m + 4.0);
    const Vec2 place = actor.motion.centre + d / range * later;
    AddEcho(view, place, actor.VelocityAt(actor.motion.centre),
            strength - random.Uniform(8.0, 18.0), id);
  }
  if (range < 25.0 && random.Bernoulli(spec_.double_bounce)) {  // There and back twice.
    const Vec2 nearest = view.place + d * std::max(0.3, 1.0 - 0.4 * actor.box().length_m / range);
    AddEcho(view, view.place + 2.0 * (nearest - view.place),
            2.0 * actor.motion.velocity - view.velocity, strength - random.Uniform(6.0, 14.0),
            kNobody);
  }
  const auto spell = static_cast<std::uint64_t>(snapshot.time_s / kSpell_s);
  const bool in_spell = SubjectRandom(seed_, "family image", {index_, spell, actor.actor->id})
                            .Bernoulli(spec_.mirror);
  if (!in_spell || !random.Bernoulli(0.7)) return;
  const auto over = [&](const Vec2& a, const Vec2& b) {
    const Vec2 image = Mirrored(actor.motion.centre, a, b);
    const Vec2 way = image - view.place;
    const double length = way.norm();
    if (length > 90.0 || length < 1.0) return false;
    const auto bounce = RayHitsSegment(view.place, way / length, a, b);
    if (!bounce || *bounce >= length) return false;
    if (*bounce > view.skyline.FreeRange(view.AzimuthTo(image)) + 0.5) return false;
    AddEcho(view, image, Mirrored(a + actor.motion.velocity, a, b) - a,
            strength - random.Uniform(6.0, 14.0), kNobody);
    return true;
  };
  for (const auto& [a, b] : view.mirrors) {
    if (over(a, b)) return;
  }
  for (const ActorState& other : snapshot.actors) {  // The sides of lorries mirror, too.
    if (other.actor == actor.actor || other.actor->size.length_m < 6.0) continue;
    const auto corners = other.box().Corners();
    if (over(corners[0], corners[1]) || over(corners[2], corners[3])) return;
  }
}

void RadarFamily::AddScenery(const RadarView& view, Random& random) {
  for (const Scatterer& scatterer : view.scatterers) {
    const Vec2 d = scatterer.place - view.place;
    if (!scatterer.normal.isZero() && scatterer.normal.dot(d) >= 0.0) continue;
    if (!view.Covers(scatterer.place)) continue;
    if (d.norm() > view.skyline.FreeRange(view.AzimuthTo(scatterer.place)) + 0.5) continue;
    if (!random.Bernoulli(scatterer.probability)) continue;
    AddEcho(view, scatterer.place, Vec2::Zero(),
            20.0 + scatterer.rcs_dbsm + random.Normal(0.0, spec_.fluctuation_db), kNobody);
  }
}

void RadarFamily::AddClutter(const RadarView& view, Random& random) {
  const auto add = [&](double farthest_m, double rate_mps, double snr_db) {
    const double range = random.Uniform(std::max(1.0, view.radar.min_range_m), farthest_m);
    const double azimuth = random.Uniform(-view.radar.half_fov_rad, view.radar.half_fov_rad);
    const Vec2 direction = Direction(view.yaw_rad + azimuth);
    echoes_.push_back({range, azimuth, rate_mps - view.velocity.dot(direction), snr_db, kNobody});
  };
  const int ground = random.Poisson(spec_.ground_per_scan);
  for (int k = 0; k < ground; ++k) {
    add(std::min(70.0, view.radar.max_range_m), random.Normal(0.0, 0.1),
        spec_.threshold_db + random.Uniform(0.0, 6.0));
  }
  const int drops = random.Poisson(spec_.rain_per_scan);
  for (int k = 0; k < drops; ++k) {
    add(25.0, random.Normal(0.0, 1.5), spec_.threshold_db + random.Uniform(0.0, 5.0));
  }
  if (!random.Bernoulli(spec_.interference_share)) return;
  for (int k = 10 + static_cast<int>(20.0 * random.Uniform()); k > 0; --k) {
    add(view.radar.max_range_m, random.Uniform(-30.0, 30.0),
        spec_.threshold_db + random.Uniform(0.0, 12.0));
  }
}

// From the strongest on: each takes in what is in its cell.
void RadarFamily::MergeCells() {
  std::erase_if(echoes_, [&](const Echo& echo) { return echo.snr_db < spec_.threshold_db - 10.0; });
  std::stable_sort(echoes_.begin(), echoes_.end(),
                   [](const Echo& a, const Echo& b) { return a.snr_db > b.snr_db; });
  const double cell_azimuth = FromDegrees(spec_.cell_azimuth_deg);
  std::vector<Echo> merged;
  std::vector<char> is_taken(echoes_.size(), 0);
  for (std::size_t i = 0; i < echoes_.size(); ++i) {
    if (is_taken[i] != 0) continue;
    Echo cell = echoes_[i];
    double total = 0.0, range = 0.0, azimuth = 0.0, rate = 0.0;
    for (std::size_t j = i; j < echoes_.size(); ++j) {
      const Echo& echo = echoes_[j];
      if (is_taken[j] != 0 || std::abs(echo.range_m - cell.range_m) > spec_.cell_range_m ||
          std::abs(echo.azimuth_rad - cell.azimuth_rad) > cell_azimuth ||
          std::abs(echo.rate_mps - cell.rate_mps) > spec_.cell_rate_mps) {
        continue;
      }
      is_taken[j] = 1;
      const double power = Power(echo.snr_db);
      total += power;
      range += power * echo.range_m;
      azimuth += power * echo.azimuth_rad;
      rate += power * echo.rate_mps;
    }
    cell.range_m = range / total;
    cell.azimuth_rad = azimuth / total;
    cell.rate_mps = rate / total;
    cell.snr_db = Decibel(total);
    if (cell.snr_db >= spec_.threshold_db) merged.push_back(cell);
  }
  std::map<std::int64_t, int> count;  // The strongest of each vehicle.
  std::erase_if(merged, [&](const Echo& echo) {
    return echo.vehicle != kNobody && ++count[echo.vehicle] > spec_.most_returns;
  });
  echoes_ = std::move(merged);
}

void RadarFamily::Report(const RadarView& view, Random& random, radar_scan_t& scan) {
  const RadarConfig& radar = view.radar;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const Echo& echo : echoes_) {
    // The data sheet's sigmas hold at 25 dB; +-20 dB are a factor of about 2.
    const double scale =
        noise_scale_ * std::clamp(std::pow(10.0, (25.0 - echo.snr_db) / 60.0), 0.6, 2.0);
    const double range =
        std::max(0.05, echo.range_m + random.Normal(0.0, scale * radar.range_sigma_m));
    const double azimuth = echo.azimuth_rad + random.Normal(0.0, scale * radar.azimuth_sigma_rad);
    const double rate = echo.rate_mps + random.Normal(0.0, scale * radar.range_rate_sigma_mps);
    radar_detection_t detection = Reported(radar, range, azimuth, rate);
    detection.snr_db = spec_.snr_given ? echo.snr_db : kNone;
    detection.rcs_dbsm =
        spec_.snr_given ? echo.snr_db - 30.0 + 40.0 * std::log10(range / kReference_m) : kNone;
    scan.detections.push_back(detection);
  }
}

void RadarFamily::Scan(const Snapshot& snapshot, std::int64_t seq, const RadarView& view,
                       radar_scan_t& scan) {
  const auto number = static_cast<std::uint64_t>(seq);
  echoes_.clear();
  for (std::size_t i = 0; i < snapshot.actors.size(); ++i) {
    if (view.open_rays[i].empty()) continue;
    const ActorState& actor = snapshot.actors[i];
    Random random = SubjectRandom(seed_, "family vehicle", {index_, number, actor.actor->id});
    AddVehicle(snapshot, actor, i, view, random);
    AddImages(snapshot, actor, view, random);
  }
  Random random = SubjectRandom(seed_, "family scan", {index_, number});
  const bool gives_objects = view.radar.output == RadarOutput::kObjects;
  if (!gives_objects) {
    AddScenery(view, random);
    AddClutter(view, random);
  }
  MergeCells();
  if (gives_objects) {
    const auto is_seen = [this](std::int64_t id) {
      return std::ranges::any_of(echoes_, [id](const Echo& echo) { return echo.vehicle == id; });
    };
    objects_.Report(snapshot, view, is_seen, random, scan);
  } else {
    Report(view, random, scan);
  }
}

}  // namespace v2vouch::sim
