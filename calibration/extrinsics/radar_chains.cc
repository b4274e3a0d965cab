// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/radar_chains.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace v2vouch {
namespace {

constexpr double kMoving_mps = 1.5;  // Range rate beyond that of a stationary world.
constexpr double kJoin_m = 2.5;      // Reflections of one vehicle in one scan.
constexpr double kJoin_mps = 1.5;
constexpr double kGate_m = 1.2;  // From the prediction, plus three sigma across.
constexpr double kLost_s = 0.25;
constexpr std::size_t kMinHits = 6;

struct Cluster {
  ChainHit hit;
  double radial_mps = 0.0;  // Over ground, along the ray.
  double ray_O = 0.0;
  double range_rate_mps = 0.0;
  int reflections = 0;
};

struct Open {
  RadarChain chain;
  double vx = 0.0;
  double vy = 0.0;
};

std::vector<Cluster> MovingClusters(const RadarScan& scan, const EgoTrack& ego,
                                    const RadarConfig& config, const double* mounting,
                                    const double* ego_values) {
  std::vector<Cluster> clusters;
  const auto nearest = ego.Nearest(scan.stamp);
  const auto place = ego.At(scan.stamp);
  if (!nearest || !place) return clusters;
  const EgoTrack::Sample& sample = ego.samples()[*nearest];
  const double omega = sample.yaw_rate_radps - ego_values[MountingParameters::kYawRateBias];
  const double vx =
      sample.speed_mps / ego_values[MountingParameters::kSpeedScale] - omega * mounting[1];
  const double vy = omega * mounting[0];
  for (const RadarDetection& detection : scan.detections) {
    const double bearing = mounting[2] + detection.azimuth_rad;
    const double c = std::cos(bearing);
    const double s = std::sin(bearing);
    const double radial = detection.range_rate_mps + vx * c + vy * s;
    const double across = vy * c - vx * s;
    if (std::abs(radial) < kMoving_mps + 4.0 * std::abs(across) * config.azimuth_sigma_rad) {
      continue;
    }
    const double x = mounting[0] + detection.range_m * c;
    const double y = mounting[1] + detection.range_m * s;
    const double cy = std::cos(place->yaw_rad);
    const double sy = std::sin(place->yaw_rad);
    const ChainHit hit{scan.stamp, detection.range_m, detection.azimuth_rad,
                       place->x_m + cy * x - sy * y, place->y_m + sy * x + cy * y};
    const auto same = std::ranges::find_if(clusters, [&](const Cluster& other) {
      return std::hypot(other.hit.x_O - hit.x_O, other.hit.y_O - hit.y_O) < kJoin_m &&
             std::abs(other.range_rate_mps - detection.range_rate_mps) < kJoin_mps;
    });
    if (same == clusters.end()) {
      clusters.push_back({hit, radial, place->yaw_rad + bearing, detection.range_rate_mps, 1});
      continue;
    }
    const double share = 1.0 / ++same->reflections;
    // The nearest: that is where the foot of a box is, too.
    same->hit.range_m = std::min(same->hit.range_m, hit.range_m);
    same->hit.azimuth_rad += share * (hit.azimuth_rad - same->hit.azimuth_rad);
    same->hit.x_O += share * (hit.x_O - same->hit.x_O);
    same->hit.y_O += share * (hit.y_O - same->hit.y_O);
  }
  return clusters;
}

void Follow(const std::vector<Cluster>& clusters, double azimuth_sigma_rad, int radar,
            std::vector<Open>& open) {
  struct Pair {
    double distance;
    std::size_t chain, cluster;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const ChainHit& last = open[i].chain.hits.back();
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      const ChainHit& hit = clusters[k].hit;
      const double dt_s = ToSeconds(hit.stamp - last.stamp);
      const double distance = std::hypot(last.x_O + dt_s * open[i].vx - hit.x_O,
                                         last.y_O + dt_s * open[i].vy - hit.y_O);
      const double young = open[i].chain.hits.size() < 4 ? 1.5 : 1.0;
      if (distance < young * (kGate_m + 3.0 * hit.range_m * azimuth_sigma_rad)) {
        pairs.push_back({distance, i, k});
      }
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::distance);
  std::vector<bool> is_used(clusters.size(), false);
  std::vector<bool> is_fed(open.size(), false);
  for (const Pair& pair : pairs) {
    if (is_used[pair.cluster] || is_fed[pair.chain]) continue;
    is_used[pair.cluster] = true;
    is_fed[pair.chain] = true;
    Open& chain = open[pair.chain];
    const ChainHit& hit = clusters[pair.cluster].hit;
    // Velocity over the last hits, so that noise of one does not matter.
    chain.chain.hits.push_back(hit);
    const std::size_t n = chain.chain.hits.size();
    const ChainHit& before = chain.chain.hits[n > 8 ? n - 8 : 0];
    const double span_s = ToSeconds(hit.stamp - before.stamp);
    if (span_s > 0.15) {
      chain.vx = (hit.x_O - before.x_O) / span_s;
      chain.vy = (hit.y_O - before.y_O) / span_s;
    }
  }
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    if (is_used[k]) continue;
    const Cluster& cluster = clusters[k];
    open.push_back({{radar, {cluster.hit}},
                    cluster.radial_mps * std::cos(cluster.ray_O),
                    cluster.radial_mps * std::sin(cluster.ray_O)});
  }
}

}  // namespace

std::vector<RadarChain> ChainMovingReturns(const DriveLog& log, const EgoTrack& ego,
                                           const VehicleConfig& vehicle,
                                           const MountingParameters& parameters) {
  std::vector<std::vector<Open>> open(vehicle.radars.size());
  std::vector<RadarChain> chains;
  const auto close = [&](std::vector<Open>& of_radar, Timestamp before) {
    std::erase_if(of_radar, [&](Open& one) {
      if (one.chain.hits.back().stamp >= before) return false;
      if (one.chain.hits.size() >= kMinHits) chains.push_back(std::move(one.chain));
      return true;
    });
  };
  for (const RadarScan& scan : log.scans) {
    const auto radar = static_cast<std::size_t>(scan.radar);
    const RadarConfig& config = vehicle.radars[radar];
    close(open[radar], scan.stamp - FromSeconds(kLost_s));
    Follow(MovingClusters(scan, ego, config, parameters.Radar(scan.radar), parameters.Ego()),
           config.azimuth_sigma_rad, scan.radar, open[radar]);
  }
  for (auto& of_radar : open) close(of_radar, Timestamp::max());
  return chains;
}

}  // namespace v2vouch
