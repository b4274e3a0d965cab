// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// GPS bias of one sender relative to the ego's, axes east and north [m].
struct BiasEstimate {
  Eigen::Vector2d mean_en = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// One sensor-confirmed difference: claimed minus sensed position, never bias-corrected.
struct BiasResidual {
  SenderId sender = 0;
  Timestamp stamp{};
  Eigen::Vector2d claimed_minus_sensed_en = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

/// Why a sender's bias is not used.
enum class BiasVerdict : std::int8_t {
  kUsed = 0,
  kTooFew = 1,       ///< Residuals; nothing is said yet.
  kTooLarge = 2,     ///< Beyond what any receiver is off by.
  kChanges = 3,      ///< Too much within the window, or unlike any receiver's noise.
  kLeadsCommon = 4,  ///< The common part hangs on this sender alone.
};

/// What one solve said.
struct BiasReport {
  struct Sender {
    SenderId sender = 0;
    BiasVerdict verdict = BiasVerdict::kTooFew;
    BiasEstimate bias{};  ///< Its own and the common part together; nothing where kTooFew.
    double change_m = 0.0;
  };
  std::optional<Timestamp> solved_at;
  std::optional<BiasEstimate> common;  ///< What all are off by. nullopt: too few senders.
  std::vector<Sender> senders;         ///< In order of their ids; quarantined ones included.
};

/// Where GPS bias estimates come from. Settled state: fed with data older than the replay buffer
/// only, so it is never rolled back. Implementations must be deterministic in message time.
class BiasEstimator {
 public:
  virtual ~BiasEstimator() = default;
  /// In order of time.
  virtual void Observe(const BiasResidual& residual) = 0;
  /// Everything up to `settled` has been observed; solves for every whole second that has passed.
  virtual void AdvanceTo(Timestamp settled) = 0;
  /// What to expect of a message of `sender` at `at`: by data so much older that it was settled
  /// whatever the order of arrival. nullopt: nothing known beyond the prior.
  [[nodiscard]] virtual std::optional<BiasEstimate> Estimate(SenderId sender,
                                                             Timestamp at) const = 0;
  /// Of the newest solve.
  [[nodiscard]] virtual const BiasReport& report() const = 0;
  /// Message time starts again; nothing is known any more.
  virtual void Restart() = 0;
};

/// Knows nothing: every sender keeps the prior.
class NullBiasEstimator : public BiasEstimator {
 public:
  void Observe(const BiasResidual&) override {}
  void AdvanceTo(Timestamp) override {}
  [[nodiscard]] std::optional<BiasEstimate> Estimate(SenderId, Timestamp) const override {
    return std::nullopt;
  }
  [[nodiscard]] const BiasReport& report() const override { return report_; }
  void Restart() override {}

 private:
  BiasReport report_;
};

}  // namespace v2vouch
