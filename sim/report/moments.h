// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/behaviour/evaluation.h"

namespace v2vouch::evaluation {

/// A stretch of time, seconds since the first truth sample.
struct Interval {
  double from_s = 0.0;
  double to_s = 0.0;
};

struct Moment {
  std::size_t instant = 0;
  double t_s = 0.0;
  std::string title;
};

/// The vehicle whose story the report tells: of those that send BSMs and were seen, the one that no
/// sensor sees longest within the disc afterwards (hidden or out of view), up to the longest
/// bridging budget per stretch;
/// stretches that end with the vehicle seen again count double. Lower id on a tie.
/// @return index into Truth::objects, or nothing where no such vehicle is.
std::optional<std::size_t> CriticalVehicle(const Evaluation& evaluation);

/// When `object` is hidden or out of view, or `only` one of the two, within the disc, from its
/// first sight on if `after_sight`.
std::vector<Interval> UnseenIntervals(const Evaluation& evaluation, std::size_t object,
                                      bool after_sight, std::optional<Sighting> only = {});

/// Three moments worth a picture: seen, unseen, back (or still unseen). Without a critical vehicle,
/// the quarters of the run.
std::vector<Moment> ChooseMoments(const Evaluation& evaluation,
                                  std::optional<std::size_t> critical);

}  // namespace v2vouch::evaluation
