// SPDX-License-Identifier: Apache-2.0
#include "calibration/gps_bias/gps_bias.h"

#include <algorithm>

namespace v2vouch {

void GpsBias::AdvanceTo(Timestamp settled) {
  const Timestamp second = FromMicros(ToMicros(settled) / kSecond_us * kSecond_us);
  if (solved_at_ && second <= *solved_at_) return;
  window_.Forget(second);
  Solve(second);
  solved_at_ = second;
}

void GpsBias::Solve(Timestamp second) {
  solved_.clear();
  common_.reset();
  std::vector<SenderBlocks> blocks = window_.At(second);
  std::erase_if(blocks, [&](const SenderBlocks& one) {
    if (one.residuals >= config_.min_residuals) return false;
    solved_.push_back({.sender = one.sender});
    return true;
  });
  while (!blocks.empty()) {
    const BiasSolution solution = SolveBias(blocks, second, config_);
    if (!solution.is_usable) break;
    // One at a time, the gravest first: who leads the others astray makes them look wrong.
    std::size_t worst = blocks.size();
    BiasVerdict verdict = BiasVerdict::kUsed;
    for (std::size_t j = 0; j < blocks.size(); ++j) {
      const BiasVerdict one = Judge(solution.senders[j], blocks.size());
      if (one == BiasVerdict::kUsed) continue;
      const bool is_worse = worst == blocks.size() || solution.senders[j].leave_one_out >
                                                          solution.senders[worst].leave_one_out;
      if (!is_worse) continue;
      worst = j;
      verdict = one;
    }
    if (worst < blocks.size()) {
      const SenderSolution& one = solution.senders[worst];
      solved_.push_back({one.sender, verdict, one.bias, one.change_m});
      blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(worst));
      continue;
    }
    for (const SenderSolution& one : solution.senders) {
      solved_.push_back({one.sender, BiasVerdict::kUsed, one.bias, one.change_m});
    }
    if (blocks.size() >= static_cast<std::size_t>(config_.min_common_senders)) {
      common_ = solution.common;
    }
    break;
  }
  std::ranges::sort(solved_, {}, &Sender::sender);
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

std::optional<BiasEstimate> GpsBias::Estimate(SenderId sender) const {
  const auto at = std::ranges::lower_bound(solved_, sender, {}, &Sender::sender);
  const bool is_known = at != solved_.end() && at->sender == sender;
  if (is_known && at->verdict == BiasVerdict::kUsed) return at->bias;
  if (is_known && at->verdict != BiasVerdict::kTooFew) return std::nullopt;
  // A stranger: what all are off by, and the doubt of its own part.
  if (!common_) return std::nullopt;
  const double own = config_.sender_sigma_m * config_.sender_sigma_m +
                     config_.wander_sigma_m * config_.wander_sigma_m;
  return BiasEstimate{common_->mean_en, common_->covariance + own * Eigen::Matrix2d::Identity()};
}

}  // namespace v2vouch
