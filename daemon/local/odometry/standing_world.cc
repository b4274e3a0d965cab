// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/odometry/standing_world.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <tuple>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kLeastCosine = 0.34;  // Beyond 70 degrees a vote's noise is three times Doppler's.
constexpr double kCell_m = 3.0;
constexpr double kBeside_m = 1.5;
constexpr double kLeastGate_mps = 0.2;
constexpr double kWindow_mps = 0.5;  // Of the search for the strongest speed.
constexpr std::size_t kMostVotes = 400;
constexpr int kCells = 512;
using Cells = std::bitset<kCells>;

int CellOf(double x_m, double y_m) {
  const auto ix = static_cast<long>(std::floor(x_m / kCell_m));
  const auto iy = static_cast<long>(std::floor(y_m / kCell_m));
  const auto hash =
      static_cast<unsigned long>(ix * 73856093L) ^ static_cast<unsigned long>(iy * 19349663L);
  return static_cast<int>(hash % static_cast<unsigned long>(kCells));
}

}  // namespace

void StandingWorld::Read(const RadarScan& scan, const RadarConfig& radar, double yaw_rate_radps) {
  votes_.clear();
  // A full radar does not cost more than 400 votes: every second, third, ... return is asked.
  const std::size_t stride = 1 + scan.detections.size() / kMostVotes;
  for (std::size_t i = 0; i < scan.detections.size(); i += stride) {
    const RadarDetection& d = scan.detections[i];
    if (!std::isfinite(d.range_m) || !std::isfinite(d.azimuth_rad) ||
        !std::isfinite(d.range_rate_mps) || d.range_m < std::max(1.0, radar.min_range_m) ||
        d.range_m > radar.max_range_m) {
      continue;
    }
    const double azimuth = d.azimuth_rad + radar.yaw_rad;
    const double c = std::cos(azimuth);
    const double s = std::sin(azimuth);
    if (std::abs(c) < kLeastCosine) continue;
    Vote vote;
    const double turning_mps = yaw_rate_radps * (radar.x_m * s - radar.y_m * c);
    vote.speed_mps = (-d.range_rate_mps - turning_mps) / c;
    vote.sigma_mps =
        std::hypot(radar.range_rate_sigma_mps, vote.speed_mps * s * radar.azimuth_sigma_rad) /
        std::abs(c);
    vote.lever_m = radar.x_m * s / c - radar.y_m;
    const double x_m = radar.x_m + d.range_m * c;
    const double y_m = radar.y_m + d.range_m * s;
    vote.cell = CellOf(x_m, y_m);
    vote.side = std::abs(y_m) < kBeside_m ? 0 : (y_m > 0.0 ? 1 : -1);
    votes_.push_back(vote);
  }
  std::sort(votes_.begin(), votes_.end(), [](const Vote& a, const Vote& b) {
    return std::tie(a.speed_mps, a.cell, a.sigma_mps, a.side) <
           std::tie(b.speed_mps, b.cell, b.sigma_mps, b.side);
  });
}

SpeedSupport StandingWorld::Of(double speed_mps) const {
  SpeedSupport support;
  Cells all, left, right;
  double weights = 0.0;
  double sum = 0.0;
  for (const Vote& vote : votes_) {
    const double off_mps = vote.speed_mps - speed_mps;
    if (std::abs(off_mps) > std::max(kLeastGate_mps, 3.0 * vote.sigma_mps)) continue;
    const auto cell = static_cast<std::size_t>(vote.cell);
    all.set(cell);
    if (vote.side > 0) left.set(cell);
    if (vote.side < 0) right.set(cell);
    const double weight = 1.0 / (vote.sigma_mps * vote.sigma_mps);
    weights += weight;
    sum += weight * off_mps;
  }
  support.cells = static_cast<int>(all.count());
  support.left = static_cast<int>(left.count());
  support.right = static_cast<int>(right.count());
  support.speed_mps = weights > 0.0 ? speed_mps + sum / weights : speed_mps;
  support.sigma_mps = weights > 0.0 ? 1.0 / std::sqrt(weights) : 0.0;
  return support;
}

SpeedSupport StandingWorld::Strongest(double low_mps, double high_mps) {
  std::array<int, kCells> count{};
  int distinct = 0;
  int most = 0;
  double best_mps = 0.0;
  std::size_t begin = 0;
  for (const Vote& vote : votes_) {
    if (vote.speed_mps < low_mps || vote.speed_mps > high_mps) continue;
    while (votes_[begin].speed_mps < std::max(low_mps, vote.speed_mps - kWindow_mps)) {
      if (votes_[begin].speed_mps >= low_mps &&
          --count[static_cast<std::size_t>(votes_[begin].cell)] == 0) {
        --distinct;
      }
      ++begin;
    }
    if (count[static_cast<std::size_t>(vote.cell)]++ == 0) ++distinct;
    if (distinct > most) {
      most = distinct;
      best_mps = 0.5 * (votes_[begin].speed_mps + vote.speed_mps);
    }
  }
  if (most == 0) return {};
  // Twice: the first mean is drawn to the middle of a window that was cut by chance.
  return Of(Of(best_mps).speed_mps);
}

}  // namespace v2vouch
