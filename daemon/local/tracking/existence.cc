// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/existence.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace v2vouch {
namespace {

constexpr std::size_t kExact = 4;
constexpr double kMaxBirth = 0.3;

// Sums the weights of all matchings of one small cluster by depth-first search over its tracks.
struct Enumeration {
  std::size_t tracks = 0;
  std::size_t measurements = 0;
  std::array<std::array<double, kExact>, kExact> ratio{};
  std::array<double, kExact> missed{};
  std::array<int, kExact> choice{};
  double total = 0.0;
  std::array<double, kExact> detected{};
  std::array<double, kExact> explained{};

  void Visit(std::size_t track, double weight, unsigned used) {
    if (track == tracks) {
      total += weight;
      for (std::size_t i = 0; i < tracks; ++i) {
        if (choice[i] < 0) continue;
        detected[i] += weight;
        explained[static_cast<std::size_t>(choice[i])] += weight;
      }
      return;
    }
    choice[track] = -1;
    Visit(track + 1, weight * missed[track], used);
    for (std::size_t j = 0; j < measurements; ++j) {
      if ((used >> j & 1U) != 0 || ratio[track][j] <= 0.0) continue;
      choice[track] = static_cast<int>(j);
      Visit(track + 1, weight * ratio[track][j], used | 1U << j);
    }
  }
};

}  // namespace

double ExistenceAfterMiss(double existence, double detection_probability) {
  const double remaining = 1.0 - existence * detection_probability;
  return remaining > 0.0 ? existence * (1.0 - detection_probability) / remaining : 0.0;
}

double BirthExistence(double births, double clutter) {
  return std::clamp(births / (births + clutter), kMinBirth, kMaxBirth);
}

int AssociationMarginals::Root(int node) {
  while (parent_[static_cast<std::size_t>(node)] != node) {
    const auto n = static_cast<std::size_t>(node);
    parent_[n] = parent_[static_cast<std::size_t>(parent_[n])];
    node = parent_[n];
  }
  return node;
}

void AssociationMarginals::Compute(std::span<const GatedPair> pairs, std::span<const double> missed,
                                   std::span<const int> assigned, std::size_t measurements) {
  const std::size_t tracks = missed.size();
  detected_.assign(tracks, 0.0);
  explained_.assign(measurements, 0.0);
  // Connected clusters; the root of a cluster is its first track.
  parent_.resize(tracks + measurements);
  for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = static_cast<int>(i);
  for (const GatedPair& pair : pairs) {
    const int a = Root(pair.track);
    const int b = Root(static_cast<int>(tracks) + pair.measurement);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  order_.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) order_[i] = static_cast<int>(i);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) {
    const int root_a = Root(pairs[static_cast<std::size_t>(a)].track);
    const int root_b = Root(pairs[static_cast<std::size_t>(b)].track);
    return root_a != root_b ? root_a < root_b : a < b;
  });
  for (std::size_t begin = 0; begin < order_.size();) {
    const int root = Root(pairs[static_cast<std::size_t>(order_[begin])].track);
    std::size_t end = begin;
    while (end < order_.size() &&
           Root(pairs[static_cast<std::size_t>(order_[end])].track) == root) {
      ++end;
    }
    const auto cluster = std::span<const int>(order_).subspan(begin, end - begin);
    begin = end;

    Enumeration sum;
    std::array<int, kExact> track_of{};
    std::array<int, kExact> measurement_of{};
    bool is_small = true;
    const auto place = [&is_small](int id, std::array<int, kExact>& ids, std::size_t& count) {
      for (std::size_t k = 0; k < count; ++k) {
        if (ids[k] == id) return k;
      }
      if (count == kExact) {
        is_small = false;
        return std::size_t{0};
      }
      ids[count] = id;
      return count++;
    };
    for (const int index : cluster) {
      const GatedPair& pair = pairs[static_cast<std::size_t>(index)];
      const std::size_t i = place(pair.track, track_of, sum.tracks);
      const std::size_t j = place(pair.measurement, measurement_of, sum.measurements);
      if (!is_small) break;
      sum.ratio[i][j] = pair.ratio;
      sum.missed[i] = missed[static_cast<std::size_t>(pair.track)];
    }
    if (is_small) {
      sum.Visit(0, 1.0, 0);
      if (!(sum.total > 0.0) || !std::isfinite(sum.total)) is_small = false;
    }
    if (is_small) {
      for (std::size_t i = 0; i < sum.tracks; ++i) {
        detected_[static_cast<std::size_t>(track_of[i])] = sum.detected[i] / sum.total;
      }
      for (std::size_t j = 0; j < sum.measurements; ++j) {
        explained_[static_cast<std::size_t>(measurement_of[j])] = sum.explained[j] / sum.total;
      }
      continue;
    }
    for (const int index : cluster) {
      const GatedPair& pair = pairs[static_cast<std::size_t>(index)];
      const auto i = static_cast<std::size_t>(pair.track);
      if (assigned[i] != pair.measurement) continue;
      const double share = pair.ratio / (pair.ratio + missed[i]);
      detected_[i] = share;
      explained_[static_cast<std::size_t>(pair.measurement)] = share;
    }
  }
}

}  // namespace v2vouch
