// SPDX-License-Identifier: Apache-2.0
#include "sim/baseline/radar_clusters.h"

#include <algorithm>
#include <cstddef>

namespace v2vouch::baseline {
namespace {

constexpr double kLink_m = 1.8, kLink_mps = 1.5;
constexpr double kStrong_db = 10.0;

}  // namespace

std::vector<Cluster> ClustersOf(const RadarConfig& radar, const radar_scan_t& scan,
                                const EgoInOdometry& ego) {
  using Vec2 = Eigen::Vector2d;
  struct Return {
    Vec2 p_O;
    double range_m, rate_mps, ground_mps, snr_db;
    int group = -1;
  };
  const Vec2 antenna_B(radar.x_m, radar.y_m);
  const Vec2 ahead = Direction(ego.yaw_O), left(-ahead.y(), ahead.x());
  const Vec2 antenna_O = ego.p_O + antenna_B.x() * ahead + antenna_B.y() * left;
  const Vec2 velocity_O = (ego.speed_mps - ego.yaw_rate_radps * antenna_B.y()) * ahead +
                          ego.yaw_rate_radps * antenna_B.x() * left;
  std::vector<Return> returns;
  for (const radar_detection_t& d : scan.detections) {
    if (!std::isfinite(d.range_m) || !std::isfinite(d.azimuth_rad)) continue;
    const double range = d.range_m + radar.range_offset_m;
    const double azimuth = radar.yaw_rad + (radar.flip_azimuth ? -d.azimuth_rad : d.azimuth_rad);
    const double rate = radar.flip_range_rate ? -d.range_rate_mps : d.range_rate_mps;
    const Vec2 way = Direction(ego.yaw_O + azimuth);
    returns.push_back({antenna_O + range * way, range, rate, rate + velocity_O.dot(way),
                       std::isfinite(d.snr_db) ? d.snr_db : 20.0});
  }
  std::vector<Cluster> clusters;
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (returns[i].group >= 0) continue;
    const int group = static_cast<int>(clusters.size());
    returns[i].group = group;
    members.assign(1, i);
    for (std::size_t next = 0; next < members.size(); ++next) {
      const Return& from = returns[members[next]];
      for (std::size_t j = 0; j < returns.size(); ++j) {
        Return& to = returns[j];
        if (to.group >= 0 || (to.p_O - from.p_O).norm() > kLink_m ||
            std::abs(to.ground_mps - from.ground_mps) > kLink_mps) {
          continue;
        }
        to.group = group;
        members.push_back(j);
      }
    }
    const auto strongest =
        *std::ranges::max_element(members, {}, [&](std::size_t k) { return returns[k].snr_db; });
    std::size_t nearest = strongest;
    for (const std::size_t k : members) {
      const bool is_strong = returns[k].snr_db >= returns[strongest].snr_db - kStrong_db;
      if (is_strong && returns[k].range_m < returns[nearest].range_m) nearest = k;
    }
    clusters.push_back({returns[nearest].p_O, antenna_O, velocity_O, returns[strongest].rate_mps,
                        std::abs(returns[strongest].ground_mps) > kMoving_mps});
  }
  return clusters;
}

}  // namespace v2vouch::baseline
