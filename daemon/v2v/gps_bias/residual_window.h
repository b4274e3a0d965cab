// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "daemon/common/data/bias.h"
#include "daemon/v2v/gps_bias/gps_bias_config.h"

namespace v2vouch {

inline constexpr std::int64_t kSecond_us = 1'000'000;

/// The residuals of one sender in one whole second of message time, as one.
struct BiasBlock {
  Timestamp stamp{};  ///< Mean of the residuals' own.
  Eigen::Vector2d mean_en = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< Of the mean.
  int residuals = 0;
};

struct SenderBlocks {
  SenderId sender = 0;
  std::vector<BiasBlock> blocks;  ///< In order of time.
  int residuals = 0;
};

/// Residuals of the last window_s by sender, second by second. What At() gives depends on the
/// residuals alone, not on when it is asked. Bounded by max_senders.
class ResidualWindow {
 public:
  explicit ResidualWindow(const GpsBiasConfig& config) : config_(config) {}

  /// In order of time per sender. A residual that is not finite, or has no positive covariance, is
  /// ignored.
  void Add(const BiasResidual& residual);
  /// Drops what no At() from `now` on can ask for.
  void Forget(Timestamp now);
  /// Blocks of whole seconds within (second - window_s, second], senders in order of their ids.
  [[nodiscard]] std::vector<SenderBlocks> At(Timestamp second) const;

 private:
  struct Sum {
    std::int64_t second = 0;  // Since the epoch; residuals within (second - 1 s, second].
    double age_s = 0.0;       // Of the residuals against `second`, summed.
    Eigen::Vector2d residual = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    int count = 0;
  };
  struct Sender {
    SenderId id = 0;
    Timestamp last{};
    std::deque<Sum> sums;
  };
  Sender* FindOrMake(SenderId id, Timestamp now);

  GpsBiasConfig config_;
  std::vector<Sender> senders_;  // By id.
};

}  // namespace v2vouch
