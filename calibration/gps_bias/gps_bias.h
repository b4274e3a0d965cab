// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/gps_bias/bias_problem.h"
#include "calibration/gps_bias/gps_bias_config.h"
#include "calibration/gps_bias/residual_window.h"
#include "daemon/data/bias.h"

namespace v2vouch {

/// Why a sender's bias is not used.
enum class BiasVerdict : std::int8_t {
  kUsed = 0,
  kTooFew,       ///< Residuals; nothing is said yet.
  kTooLarge,     ///< Beyond max_bias_m: no bias of a receiver.
  kChanges,      ///< More than max_change_m within the window, or unlike any receiver's noise.
  kLeadsCommon,  ///< The common part hangs on this sender alone.
};

/// GPS bias per sender and common to all, by Ceres over a sliding window of sensor-confirmed
/// residuals (bias_problem.h). Solved at whole seconds of message time; each solve depends on the
/// window's residuals alone, so that how often AdvanceTo() is called changes nothing. Whoever is in
/// quarantine has no estimate and no part in the common one: the worst is put there first, then
/// the rest is solved again.
class GpsBias final : public BiasEstimator {
 public:
  explicit GpsBias(const GpsBiasConfig& config) : config_(config), window_(config) {}

  void Observe(const BiasResidual& residual) override { window_.Add(residual); }
  void AdvanceTo(Timestamp settled) override;
  [[nodiscard]] std::optional<BiasEstimate> Estimate(SenderId sender) const override;

  struct Sender {
    SenderId sender = 0;
    BiasVerdict verdict = BiasVerdict::kTooFew;
    BiasEstimate bias{};
    double change_m = 0.0;
  };
  /// Of the last solve, in order of the senders' ids; quarantined ones included.
  [[nodiscard]] const std::vector<Sender>& senders() const { return solved_; }
  /// What all are off by. nullopt: too few senders.
  [[nodiscard]] const std::optional<BiasEstimate>& common() const { return common_; }
  [[nodiscard]] std::optional<Timestamp> solved_at() const { return solved_at_; }

 private:
  void Solve(Timestamp second);
  [[nodiscard]] BiasVerdict Judge(const SenderSolution& one, std::size_t senders) const;

  GpsBiasConfig config_;
  ResidualWindow window_;
  std::vector<Sender> solved_;
  std::optional<BiasEstimate> common_;
  std::optional<Timestamp> solved_at_;
};

}  // namespace v2vouch
