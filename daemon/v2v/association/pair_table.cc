// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/pair_table.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>

namespace v2vouch {
namespace {

std::pair<SenderId, std::uint64_t> KeyOf(const PairTable::Pair& pair) {
  return {pair.sender, pair.track_id};
}

bool IsWithinGate(const PairObservation& observation, const std::optional<BiasPrior>& prior,
                  const AssociationConfig& config) {
  const double variance = config.bias_sigma_m * config.bias_sigma_m;
  Eigen::Matrix2d S = variance * Eigen::Matrix2d::Identity();
  Eigen::Vector2d nu = observation.residual_m;
  if (prior) {
    S = prior->covariance;
    nu -= prior->mean;
  }
  S += observation.alignment + observation.sensed + observation.noise;
  return nu.dot(S.inverse() * nu) <= config.new_pair_gate;
}

}  // namespace

PairTable::Pair* PairTable::Find(SenderId sender, std::uint64_t track_id) {
  const auto at = std::ranges::lower_bound(pairs_, std::pair(sender, track_id), {}, KeyOf);
  return at != pairs_.end() && KeyOf(*at) == std::pair(sender, track_id) ? &*at : nullptr;
}

PairTable::Pair* PairTable::Observe(SenderId sender, std::uint64_t track_id,
                                    const PairObservation& observation,
                                    const std::optional<BiasPrior>& prior,
                                    const AssociationConfig& config) {
  if (Pair* known = Find(sender, track_id)) {
    known->evidence.Add(observation, config);
    return known;
  }
  if (!IsWithinGate(observation, prior, config)) return nullptr;
  if (pairs_.size() >= static_cast<std::size_t>(config.max_pairs)) {
    // The weakest pair gives way; an incumbent never does. A newcomer's first message scores
    // little, so this cannot be used to flush a pair with a history.
    auto weakest = pairs_.end();
    for (auto pair = pairs_.begin(); pair != pairs_.end(); ++pair) {
      if (pair->is_incumbent) continue;
      if (weakest == pairs_.end() || pair->evidence.score() < weakest->evidence.score()) {
        weakest = pair;
      }
    }
    const PairEvidence newcomer(config, prior, observation);
    if (weakest == pairs_.end() || weakest->evidence.score() >= newcomer.score()) return nullptr;
    pairs_.erase(weakest);
  }
  const auto at = std::ranges::lower_bound(pairs_, std::pair(sender, track_id), {}, KeyOf);
  return &*pairs_.insert(
      at, {sender, track_id, false, false, PairEvidence(config, prior, observation)});
}

void PairTable::Assign(const AssociationConfig& config) {
  auto& [solver, sparse, tracks, lone, row, column] = scratch_;
  tracks.clear();
  sparse.clear();
  lone.clear();
  for (const Pair& pair : pairs_) tracks.push_back(pair.track_id);
  std::ranges::sort(tracks);
  tracks.erase(std::unique(tracks.begin(), tracks.end()), tracks.end());

  row.assign(pairs_.size(), 0);
  column.assign(pairs_.size(), 0);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    if (i == 0 || pairs_[i - 1].sender != pair.sender) lone.push_back(0.0);
    row[i] = static_cast<int>(lone.size()) - 1;
    column[i] = static_cast<int>(std::ranges::lower_bound(tracks, pair.track_id) - tracks.begin());
    const double bonus = pair.is_incumbent ? config.incumbent_bonus : 0.0;
    const double score = pair.evidence.score() + bonus;
    if (score > 0.0) sparse.push_back({row[i], column[i], -score});
  }
  const auto chosen = solver.Solve(sparse, lone.size(), tracks.size(), lone);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    pairs_[i].is_assigned = chosen[static_cast<std::size_t>(row[i])] == column[i];
  }
}

double PairTable::Margin(const Pair& pair) const {
  const auto is_taken = [&](std::uint64_t track_id) {
    return std::ranges::any_of(pairs_, [&](const Pair& other) {
      return other.is_incumbent && other.track_id == track_id && other.sender != pair.sender;
    });
  };
  double margin = std::numeric_limits<double>::infinity();
  for (const Pair& other : pairs_) {
    const bool same_sender = other.sender == pair.sender;
    const bool same_track = other.track_id == pair.track_id;
    if (same_sender == same_track) continue;  // Itself, or unrelated.
    if (same_sender && is_taken(other.track_id)) continue;
    margin = std::min(margin, pair.evidence.score() - other.evidence.score());
  }
  return margin;
}

const PairTable::Pair* PairTable::AssignedTo(SenderId sender) const {
  const auto at = std::ranges::find_if(
      pairs_, [&](const Pair& pair) { return pair.sender == sender && pair.is_assigned; });
  return at == pairs_.end() ? nullptr : &*at;
}

void PairTable::SetIncumbent(SenderId sender, std::optional<std::uint64_t> track_id) {
  for (Pair& pair : pairs_) {
    if (pair.sender == sender) pair.is_incumbent = pair.track_id == track_id;
  }
}

void PairTable::DropSender(SenderId sender) {
  std::erase_if(pairs_, [&](const Pair& pair) { return pair.sender == sender; });
}

void PairTable::TakeFrom(PairTable& other, SenderId sender, const AssociationConfig& config) {
  for (const Pair& pair : other.pairs_) {
    if (pair.sender != sender || Find(sender, pair.track_id) != nullptr) continue;
    if (pairs_.size() >= static_cast<std::size_t>(config.max_pairs)) break;
    const auto at = std::ranges::lower_bound(pairs_, KeyOf(pair), {}, KeyOf);
    Pair& taken = *pairs_.insert(at, pair);
    taken.is_incumbent = taken.is_assigned = false;
  }
  other.DropSender(sender);
}

void PairTable::Expire(Timestamp now, const AssociationConfig& config) {
  std::erase_if(pairs_, [&](const Pair& pair) {
    return ToSeconds(now - pair.evidence.last()) > config.pair_timeout_s;
  });
}

}  // namespace v2vouch
