// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/gps_bias.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace v2vouch {

namespace {

constexpr std::int64_t kSecondsKept = 16;  // More than any message can be older than the newest.
constexpr int kMostRounds = 3;             // Of putting senders in quarantine one by one.

}  // namespace

void GpsBias::AdvanceTo(Timestamp settled) {
  const std::int64_t newest = ToMicros(settled) / kSecond_us;
  std::int64_t second = newest;
  if (!solves_.empty()) {
    // After a long pause the estimates of the seconds between are never asked for.
    second = std::max(ToMicros(*solves_.back().solved_at) / kSecond_us + 1, newest - kSecondsKept);
  }
  for (; second <= newest; ++second) {
    const Timestamp at = FromMicros(second * kSecond_us);
    window_.Forget(at);
    solves_.push_back(Solve(at));
    if (solves_.size() > kSecondsKept) solves_.pop_front();
  }
}

BiasReport GpsBias::Solve(Timestamp second) const {
  BiasReport report;
  report.solved_at = second;
  std::vector<SenderBlocks> blocks = window_.At(second);
  std::erase_if(blocks, [&](const SenderBlocks& one) {
    if (one.residuals >= config_.min_residuals) return false;
    report.senders.push_back({.sender = one.sender});
    return true;
  });
  for (int round = 0; !blocks.empty(); ++round) {
    const BiasSolution solution = SolveBias(blocks, second, config_);
    if (!solution.is_usable) break;
    // A sender too far off or changing too much is judged by its own residuals: all such senders go
    // at once. A sender that distorts the common part makes others exceed the limit too: each round
    // removes only the worst sender; after the last round all that exceed the limit are removed.
    std::vector<BiasVerdict> verdicts;
    std::size_t worst = blocks.size();
    BiasVerdict gravest = BiasVerdict::kLeadsCommon;
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      verdicts.push_back(Judge(solution.senders[j], blocks.size()));
      if (verdicts[j] == BiasVerdict::kUsed) continue;
      gravest = std::min(gravest, verdicts[j]);
      const bool is_worse = worst == blocks.size() || solution.senders[j].leave_one_out >
                                                          solution.senders[worst].leave_one_out;
      if (is_worse) worst = j;
    }
    const bool is_clean = worst == blocks.size();
    const bool is_settled = is_clean || round > kMostRounds;
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      const bool is_due =
          verdicts[j] == gravest && (gravest != BiasVerdict::kLeadsCommon || j == worst);
      const bool leaves = verdicts[j] != BiasVerdict::kUsed && (is_due || round >= kMostRounds);
      if (!leaves && !is_settled) {
        verdicts[j] = BiasVerdict::kUsed;
        continue;
      }
      const SenderSolution& one = solution.senders[j];
      report.senders.push_back({one.sender, verdicts[j], one.bias, one.change_m});
    }
    if (is_settled) {
      if (is_clean && blocks.size() >= static_cast<std::size_t>(config_.min_common_senders)) {
        report.common = solution.common;
      }
      break;
    }
    std::size_t kept = 0;
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      if (verdicts[j] != BiasVerdict::kUsed) continue;
      if (kept != j) blocks[kept] = std::move(blocks[j]);
      ++kept;
    }
    blocks.resize(kept);
  }
  std::ranges::sort(report.senders, {}, &Sender::sender);
  return report;
}

BiasVerdict GpsBias::Judge(const SenderSolution& one, std::size_t senders) const {
  if (one.bias.mean_en.norm() > config_.max_bias_m) return BiasVerdict::kTooLarge;
  if (one.change_m > config_.max_change_m || one.null_chi_square > config_.null_chi_square) {
    return BiasVerdict::kChanges;
  }
  if (senders >= static_cast<std::size_t>(config_.min_common_senders) &&
      one.leave_one_out > config_.leave_one_out_gate) {
    return BiasVerdict::kLeadsCommon;
  }
  return BiasVerdict::kUsed;
}

std::optional<BiasEstimate> GpsBias::Estimate(SenderId sender, Timestamp at) const {
  const Timestamp newest = at - FromSeconds(config_.estimate_age_s);
  const auto solve = std::find_if(solves_.rbegin(), solves_.rend(),
                                  [&](const BiasReport& one) { return *one.solved_at <= newest; });
  if (solve == solves_.rend()) return std::nullopt;
  const auto found = std::ranges::lower_bound(solve->senders, sender, {}, &Sender::sender);
  const bool is_known = found != solve->senders.end() && found->sender == sender;
  if (is_known && found->verdict == BiasVerdict::kUsed) return found->bias;
  if (is_known && found->verdict != BiasVerdict::kTooFew) return std::nullopt;
  // A stranger: what all are off by, and the doubt of its own part.
  if (!solve->common) return std::nullopt;
  const double own = config_.sender_sigma_m * config_.sender_sigma_m +
                     config_.wander_sigma_m * config_.wander_sigma_m;
  return BiasEstimate{solve->common->mean_en,
                      solve->common->covariance + own * Eigen::Matrix2d::Identity()};
}

void GpsBias::Restart() {
  window_ = ResidualWindow(config_);
  solves_.clear();
}

}  // namespace v2vouch
