// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/radar/vehicle_merge.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "daemon/common/data/kinematic_limits.h"

namespace v2vouch {
namespace {

constexpr double kAcrossPrior_mps = 10.0;
constexpr double kMostSpeed_mps = kMostRoadSpeed_mps;
// Pairs of reflections that are looked at. Traffic has some thousand; interference all round has a
// hundred times as many and is no vehicle in pieces.
constexpr std::size_t kMostPairs = 8192;
constexpr double kNoiseAllowed = 2.0;  // Sigmas; 3 joins twice as many cars driving side by side.

struct Sightline {
  Eigen::Vector2d line, beside;  // Unit vectors along and across.
  double range_m;
};

// Whether the reflections, seen along their course, spread no wider than one vehicle.
template <class ForEach>
bool HasSizeOfOne(const VehicleShape& shape, const Sightline& sight,
                  const Eigen::Vector2d& velocity, const ForEach& for_each) {
  const auto& [line, beside, range_m] = sight;
  const Eigen::Vector2d course =
      (velocity.x() * line + velocity.y() * beside) / std::max(velocity.norm(), 1e-6);
  const Eigen::Vector2d flank(-course.y(), course.x());
  Eigen::Array2d low(1e9, 1e9);
  Eigen::Array2d high(-1e9, -1e9);
  for_each([&](const Reflection& r) {
    const Eigen::Vector2d p(r.x_m, r.y_m);
    const Eigen::Array2d q(p.dot(course), p.dot(flank));
    low = low.min(q);
    high = high.max(q);
  });
  const auto noise = [&shape, &sight](const Eigen::Vector2d& axis) {
    return std::hypot(shape.range_sigma_m * axis.dot(sight.line),
                      shape.azimuth_sigma_rad * sight.range_m * axis.dot(sight.beside));
  };
  const Eigen::Array2d size = high - low;
  return size.x() <= shape.length_m + kNoiseAllowed * noise(course) &&
         size.y() <= shape.width_m + kNoiseAllowed * noise(flank);
}
}  // namespace

int VehicleMerge::Root(int cluster) {
  while (parent_[static_cast<std::size_t>(cluster)] != cluster) {
    cluster = parent_[static_cast<std::size_t>(cluster)];
  }
  return cluster;
}

bool VehicleMerge::IsOneVehicle(std::span<const Reflection> reflections, const VehicleShape& shape,
                                int a, int b) const {
  const auto for_each = [&](auto&& visit) {
    for (const int cluster : {a, b}) {
      for (const int member : content_[static_cast<std::size_t>(cluster)]) {
        visit(reflections[static_cast<std::size_t>(member)]);
      }
    }
  };
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  int count = 0;
  for_each([&](const Reflection& r) {
    mean += Eigen::Vector2d(r.x_m, r.y_m);
    ++count;
  });
  mean /= count;
  const double range_m = std::max(mean.norm(), 1.0);
  const Eigen::Vector2d line = mean / range_m;
  const Eigen::Vector2d beside(-line.y(), line.x());

  // Normal equations in (along the line, across it).
  const double weight = 1.0 / (shape.ground_rate_sigma_mps * shape.ground_rate_sigma_mps);
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d y = Eigen::Vector2d::Zero();
  A(1, 1) = 1.0 / (kAcrossPrior_mps * kAcrossPrior_mps);
  for_each([&](const Reflection& r) {
    const Eigen::Vector2d p(r.x_m, r.y_m);
    const Eigen::Vector2d h = Eigen::Vector2d(p.dot(line), p.dot(beside)) / r.range_m;
    A += weight * h * h.transpose();
    y += weight * r.ground_rate_mps * h;
  });
  const Eigen::Vector2d velocity = A.inverse() * y;
  if (!(velocity.norm() < kMostSpeed_mps)) return false;
  double chi2 = A(1, 1) > 0.0 ? std::pow(velocity.y() / kAcrossPrior_mps, 2) : 0.0;
  for_each([&](const Reflection& r) {
    const Eigen::Vector2d p(r.x_m, r.y_m);
    const double rate = Eigen::Vector2d(p.dot(line), p.dot(beside)).dot(velocity) / r.range_m;
    chi2 += weight * (r.ground_rate_mps - rate) * (r.ground_rate_mps - rate);
  });
  // Mean plus three standard deviations of chi-square with count - 1 degrees of freedom.
  const double freedom = count - 1;
  if (chi2 > freedom + 3.0 * std::sqrt(2.0 * freedom)) return false;

  return HasSizeOfOne(shape, {line, beside, range_m}, velocity, for_each);
}

// Pairs of moving clusters within reach, by the distance of their nearest reflections. The
// reflections are in order of range, so the inner loop ends early.
void VehicleMerge::CollectEdges(std::span<const Reflection> reflections,
                                const VehicleShape& shape) {
  edges_.clear();
  for (std::size_t i = 0; i < reflections.size() && edges_.size() < kMostPairs; ++i) {
    if (cluster_of_[i] < 0) continue;
    for (std::size_t j = i + 1; j < reflections.size(); ++j) {
      const double reach_m = shape.gap_m + 2.0 * shape.azimuth_sigma_rad * reflections[j].range_m;
      if (reflections[j].range_m - reflections[i].range_m > reach_m) break;
      if (cluster_of_[j] < 0 || cluster_of_[j] == cluster_of_[i]) continue;
      const double dx = reflections[i].x_m - reflections[j].x_m;
      if (std::abs(dx) > reach_m) continue;
      const double dy = reflections[i].y_m - reflections[j].y_m;
      const double gap2 = dx * dx + dy * dy;
      if (gap2 > reach_m * reach_m) continue;
      // Cheap and early: no plausible speed across the ray explains this change of Doppler.
      const double rate_mps = reflections[i].ground_rate_mps - reflections[j].ground_rate_mps;
      const double turn_rad = std::sqrt(gap2) / std::max(reflections[i].range_m, 1.0);
      if (std::abs(rate_mps) >
          3.0 * kAcrossPrior_mps * turn_rad + 5.0 * shape.ground_rate_sigma_mps) {
        continue;
      }
      edges_.push_back({gap2, std::min(cluster_of_[i], cluster_of_[j]),
                        std::max(cluster_of_[i], cluster_of_[j])});
    }
  }
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.a, x.b, x.gap2) < std::tie(y.a, y.b, y.gap2);
  });
  edges_.erase(std::unique(edges_.begin(), edges_.end(),
                           [](const Edge& x, const Edge& y) { return x.a == y.a && x.b == y.b; }),
               edges_.end());
  std::sort(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.gap2, x.a, x.b) < std::tie(y.gap2, y.a, y.b);
  });
}
void VehicleMerge::Run(std::span<const Reflection> reflections, const VehicleShape& shape,
                       std::vector<int>& members, std::vector<std::size_t>& ends) {
  const std::size_t clusters = ends.size();
  content_.resize(std::max(content_.size(), clusters));
  parent_.resize(clusters);
  cluster_of_.assign(reflections.size(), -1);
  std::size_t from = 0;
  for (std::size_t i = 0; i < clusters; ++i) {
    parent_[i] = static_cast<int>(i);
    content_[i].assign(members.begin() + static_cast<std::ptrdiff_t>(from),
                       members.begin() + static_cast<std::ptrdiff_t>(ends[i]));
    for (const int member : content_[i]) {
      const auto m = static_cast<std::size_t>(member);
      if (!reflections[m].is_standing) cluster_of_[m] = static_cast<int>(i);
    }
    from = ends[i];
  }

  CollectEdges(reflections, shape);

  for (const Edge& edge : edges_) {
    const int a = std::min(Root(edge.a), Root(edge.b));
    const int b = std::max(Root(edge.a), Root(edge.b));
    if (a == b || !IsOneVehicle(reflections, shape, a, b)) continue;
    parent_[static_cast<std::size_t>(b)] = a;
    auto& into = content_[static_cast<std::size_t>(a)];
    const auto& more = content_[static_cast<std::size_t>(b)];
    into.insert(into.end(), more.begin(), more.end());
    std::sort(into.begin(), into.end());
  }

  members.clear();
  ends.clear();
  for (std::size_t i = 0; i < clusters; ++i) {
    if (parent_[i] != static_cast<int>(i)) continue;
    members.insert(members.end(), content_[i].begin(), content_[i].end());
    ends.push_back(members.size());
  }
}

}  // namespace v2vouch
