// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/common_mode.h"

#include <algorithm>

namespace v2vouch {

CommonMode::CommonMode(std::span<const SenderResidual> residuals, const CommonModeConfig& config) {
  for (const SenderResidual& residual : residuals) {
    if (residual.mean_O.norm() >= config.witness_m) continue;
    ++witnesses_;
    only_witness_ = residual.sender;
  }
  // The largest group round any one of them; ties go to the one that comes first.
  std::size_t most = 0;
  for (const SenderResidual& middle : residuals) {
    std::size_t count = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const SenderResidual& other : residuals) {
      if ((other.mean_O - middle.mean_O).norm() > config.agree_m) continue;
      ++count;
      sum += other.mean_O;
    }
    if (count <= most) continue;
    most = count;
    shift_ = sum / static_cast<double>(count);
  }
  is_shifted_ = most >= static_cast<std::size_t>(config.senders) && 2 * most > residuals.size() &&
                shift_.norm() > config.shift_m;
}

bool CommonMode::HasWitnessAgainst(SenderId sender) const {
  return witnesses_ > 1 || (witnesses_ == 1 && only_witness_ != sender);
}

void CommonModeMonitor::Judge(std::span<const SenderResidual> residuals, Timestamp now,
                              const CommonModeConfig& config) {
  const CommonMode seen(residuals, config);
  if (seen.is_shifted()) {
    shifted_ = now;
    mode_ = seen;
  } else if (!IsShifted(now, config)) {
    mode_ = seen;
  }
}

}  // namespace v2vouch
