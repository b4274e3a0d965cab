// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

/// A run written by hand, in memory: the ego stands at the origin of W and looks east for
/// `length_s`; one radar and one camera look ahead, +-30 degrees, 100 m and 120 m. Truth at 20 Hz.
class SpoofScene {
 public:
  explicit SpoofScene(double length_s);

  /// A car, 4 m x 2 m, at `p` heading east, with `speed_mps` along its heading; sender 0 = no V2V.
  void AddCar(std::int64_t id, const Eigen::Vector2d& p, double speed_mps = 0.0,
              std::uint32_t sender = 0);
  /// Hides a car from all sensors from `from_s` to `to_s`.
  void Hide(std::int64_t id, double from_s, double to_s);

  /// One message at `t_s`, true to `vehicle` (0 = none); change the returned one at will. Its
  /// verdict is `trust`, or a refusal.
  BsmTruth& Say(double t_s, std::int64_t device, std::uint32_t sender, std::int64_t vehicle,
                int trust, const std::string& refusal = "");
  /// A PRIORITY list at `t_s` with the tracks given since the last one.
  void AddTrack(std::int64_t id, std::uint32_t sender, const Eigen::Vector2d& p_W,
                double budget_s = 10.0);
  void List(double t_s);
  void Report(double t_s, std::uint32_t sender, bool is_accusation);
  /// Looks of both sensors at 20 Hz, which make cars holdable by the bound.
  void Look();

  [[nodiscard]] Timestamp At(double t_s) const;
  [[nodiscard]] const RunLog& log() const { return log_; }

  RunLog log_;

 private:
  TruthObject& Car(std::int64_t id);
  ReceivedList next_;
  std::int64_t seq_ = 0;
};

/// 10 Hz from `from_s` to before `to_s`.
void AtTenHertz(double from_s, double to_s, const std::function<void(double)>& what);

}  // namespace v2vouch::evaluation
