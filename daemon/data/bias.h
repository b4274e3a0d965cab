// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "daemon/base/time.h"
#include "daemon/data/input.h"

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

/// Where GPS bias estimates come from. Settled state: fed with data older than the replay buffer
/// only, so it is never rolled back. Implementations must be deterministic in message time.
class BiasEstimator {
 public:
  virtual ~BiasEstimator() = default;
  virtual void Observe(const BiasResidual& residual) = 0;
  /// Everything up to `settled` has been observed; solves where a whole second has passed.
  virtual void AdvanceTo(Timestamp settled) = 0;
  /// nullopt: nothing known about this sender beyond the prior.
  [[nodiscard]] virtual std::optional<BiasEstimate> Estimate(SenderId sender) const = 0;
};

/// Knows nothing: every sender keeps the prior.
class NullBiasEstimator final : public BiasEstimator {
 public:
  void Observe(const BiasResidual&) override {}
  void AdvanceTo(Timestamp) override {}
  [[nodiscard]] std::optional<BiasEstimate> Estimate(SenderId) const override {
    return std::nullopt;
  }
};

}  // namespace v2vouch
