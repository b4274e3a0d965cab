// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "daemon/common/data/bias.h"
#include "daemon/v2v/gps_bias/bias_problem.h"
#include "daemon/v2v/gps_bias/gps_bias_config.h"
#include "daemon/v2v/gps_bias/residual_window.h"

namespace v2vouch {

/// GPS bias per sender and common to all, by Ceres over a sliding window of sensor-confirmed
/// residuals (bias_problem.h). Solved for every whole second of message time; each solve depends on
/// the window's residuals alone, so that how often AdvanceTo() is called changes nothing. A
/// sender in quarantine has no estimate and no part in the common one: the worst goes there first,
/// then the rest is solved again, a bounded number of times.
class GpsBias final : public BiasEstimator {
 public:
  using Sender = BiasReport::Sender;

  explicit GpsBias(const GpsBiasConfig& config) : config_(config), window_(config) {}

  void Observe(const BiasResidual& residual) override { window_.Add(residual); }
  void AdvanceTo(Timestamp settled) override;
  /// By the newest solve at least estimate_age_s before `at`.
  [[nodiscard]] std::optional<BiasEstimate> Estimate(SenderId sender, Timestamp at) const override;
  [[nodiscard]] const BiasReport& report() const override {
    return solves_.empty() ? nothing_ : solves_.back();
  }
  void Restart() override;

 private:
  [[nodiscard]] BiasReport Solve(Timestamp second) const;
  [[nodiscard]] BiasVerdict Judge(const SenderSolution& one, std::size_t senders) const;

  GpsBiasConfig config_;
  ResidualWindow window_;
  std::deque<BiasReport> solves_;  // Of the last seconds.
  BiasReport nothing_;
};

}  // namespace v2vouch
