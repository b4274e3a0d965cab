// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "sim/world/world.h"

namespace v2vouch::sim {

/// How long each vehicle has been in joint view or hidden, at every tenth of a second of the run,
/// by truth geometry. Joint view: a radar and a camera would each detect it with probability 0.5 at
/// least, and it is 5 to 100 m from the ego. Hidden: no sensor would, and it is within 150 m and 35
/// degrees of straight ahead, where one could but for what is in the way. Joint view survives
/// gaps of up to 1.5 s, such as another car passing between.
class ViewTimeline {
 public:
  ViewTimeline(const World& world, std::uint64_t seed);

  /// `actor` is an index into World::actors(). All in seconds up to `time_s`.
  [[nodiscard]] double InViewFor(std::size_t actor, double time_s) const;
  [[nodiscard]] double HiddenFor(std::size_t actor, double time_s) const;
  /// Length of the joint view before the one that is on, or that ended last.
  [[nodiscard]] double LastViewFor(std::size_t actor, double time_s) const;

  /// Over the whole run: the longest joint view; the longest at the end of which it drives faster
  /// than 2 m/s; and the longest time hidden, driving so, after a joint view of 2 s at least.
  [[nodiscard]] double LongestInView(std::size_t actor) const { return longest_[actor].in_view_s; }
  [[nodiscard]] double LongestDriving(std::size_t actor) const { return longest_[actor].driving_s; }
  [[nodiscard]] double LongestHidden(std::size_t actor) const { return longest_[actor].hidden_s; }

 private:
  struct Cell {
    float in_view_s = 0.0f;
    float hidden_s = 0.0f;
    float last_view_s = 0.0f;
  };
  struct Longest {
    double in_view_s = 0.0;
    double driving_s = 0.0;
    double hidden_s = 0.0;
  };
  [[nodiscard]] const Cell& At(std::size_t actor, double time_s) const;

  std::vector<std::vector<Cell>> cells_;  ///< By actor, then step.
  std::vector<Longest> longest_;
};

}  // namespace v2vouch::sim
