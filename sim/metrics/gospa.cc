// SPDX-License-Identifier: Apache-2.0
#include "sim/metrics/gospa.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/check.h"

namespace v2vouch::evaluation {
namespace {

double Power(double value, double order) {
  return order == 2.0 ? value * value : std::pow(value, order);
}

}  // namespace

double Root(double power, double order) {
  return order == 2.0 ? std::sqrt(power) : std::pow(power, 1.0 / order);
}

Gospa::Gospa(const GospaParameters& parameters) : parameters_(parameters) {
  V2VOUCH_CHECK(parameters.cutoff_m > 0.0 && parameters.order >= 1.0);
  V2VOUCH_CHECK(parameters.alpha > 0.0 && parameters.alpha <= 2.0);
}

const GospaResult& Gospa::FromDistances(std::span<const double> distance, std::size_t truths,
                                        std::size_t tracks) {
  V2VOUCH_CHECK(distance.size() == truths * tracks);
  const double c = parameters_.cutoff_m;
  const double saturated = Power(c, parameters_.order);

  // The smaller set goes into the rows: each of its members is either paired closer than c or
  // costs c^p, whether it stands alone or in a saturated pair. That one rule serves every alpha.
  const bool truths_are_rows = truths <= tracks;
  const std::size_t rows = std::min(truths, tracks);
  const std::size_t columns = std::max(truths, tracks);
  cost_.assign(rows * columns, kForbidden);
  lone_.assign(rows, saturated);
  for (std::size_t i = 0; i < truths; ++i) {
    for (std::size_t j = 0; j < tracks; ++j) {
      const double d = distance[i * tracks + j];
      if (!(d < c)) continue;
      const std::size_t cell = truths_are_rows ? i * columns + j : j * columns + i;
      cost_[cell] = Power(d, parameters_.order);
    }
  }
  const auto pairs = solver_.Solve(cost_, rows, columns, lone_);

  result_ = {.assignment = std::move(result_.assignment)};
  result_.assignment.assign(truths, -1);
  for (std::size_t row = 0; row < rows; ++row) {
    if (pairs[row] < 0) continue;
    const auto column = static_cast<std::size_t>(pairs[row]);
    const std::size_t truth = truths_are_rows ? row : column;
    const std::size_t track = truths_are_rows ? column : row;
    result_.assignment[truth] = static_cast<int>(track);
    result_.localisation_pow += cost_[row * columns + column];
    ++result_.num_assigned;
  }
  result_.num_missed = static_cast<int>(truths) - result_.num_assigned;
  result_.num_false = static_cast<int>(tracks) - result_.num_assigned;
  if (parameters_.alpha == 2.0) {
    result_.missed_pow = result_.num_missed * saturated / 2.0;
    result_.false_pow = result_.num_false * saturated / 2.0;
    result_.power = result_.localisation_pow + result_.missed_pow + result_.false_pow;
  } else {
    const auto saturated_pairs = static_cast<double>(rows) - result_.num_assigned;
    const auto surplus = static_cast<double>(columns - rows);
    result_.power = result_.localisation_pow + saturated * saturated_pairs +
                    saturated / parameters_.alpha * surplus;
  }
  result_.gospa = Root(result_.power, parameters_.order);
  return result_;
}

const GospaResult& Gospa::FromPoints(std::span<const Eigen::Vector2d> truths,
                                     std::span<const Eigen::Vector2d> tracks) {
  distance_.resize(truths.size() * tracks.size());
  for (std::size_t i = 0; i < truths.size(); ++i) {
    for (std::size_t j = 0; j < tracks.size(); ++j) {
      distance_[i * tracks.size() + j] = (truths[i] - tracks[j]).norm();
    }
  }
  return FromDistances(distance_, truths.size(), tracks.size());
}

double SwitchCounter::Step(std::span<const Held> now) {
  double switches = 0.0;
  for (const Held& held : now) {
    Memory& memory = memory_[held.truth];
    const bool was_here = memory.step >= 0 && memory.step == step_ - 1;
    if (was_here && memory.track != held.track) {
      const bool is_full = memory.track != kNoTrack && held.track != kNoTrack;
      const bool is_first = memory.track == kNoTrack && !memory.ever_held;
      if (is_full) {
        switches += 1.0;
      } else if (!is_first) {
        switches += 0.5;
      }
    }
    memory.track = held.track;
    memory.ever_held = memory.ever_held || held.track != kNoTrack;
    memory.step = step_;
  }
  ++step_;
  return switches;
}

}  // namespace v2vouch::evaluation
