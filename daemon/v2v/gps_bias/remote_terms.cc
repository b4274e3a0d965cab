// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/remote_terms.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace v2vouch::remote {
namespace {

constexpr double kStanding_mps = 0.5;  // Slower, the heading is not that of the velocity.

}  // namespace

std::vector<Block> Blocks(const std::vector<RemotePair>& pairs, double white_hz) {
  std::map<std::int64_t, Block> by_second;
  const Timestamp start = pairs.front().residual.stamp;
  for (const RemotePair& pair : pairs) {
    const double time_s = ToSeconds(pair.residual.stamp - start);
    Block& block = by_second[static_cast<std::int64_t>(std::floor(time_s))];
    ++block.pairs;
    block.time_s += time_s;
    block.mean += pair.residual.claimed_minus_sensed_en;
    block.covariance += pair.residual.covariance;
    block.velocity += pair.velocity_en_mps;
    const double speed = pair.velocity_en_mps.norm();
    if (speed > kStanding_mps) block.heading += pair.velocity_en_mps / speed;
    block.place +=
        pair.range_m * Eigen::Vector2d(std::cos(pair.bearing_rad), std::sin(pair.bearing_rad));
  }
  std::vector<Block> blocks;
  for (auto& [second, block] : by_second) {
    const double n = block.pairs;
    block.time_s /= n;
    block.mean /= n;
    block.velocity /= n;
    block.heading /= n;
    block.place /= n;
    block.covariance /= n * std::min(n, white_hz);
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace v2vouch::remote
