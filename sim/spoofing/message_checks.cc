// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/message_checks.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>

#include "daemon/common/base/angle.h"
#include "sim/metrics/footprint.h"

namespace v2vouch::evaluation {
namespace {

struct Claim {
  double sent_s = 0.0;
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double course_rad = 0.0;  // Of motion.
  double speed_mps = 0.0;   // As sent: unsigned.
  Footprint box;
};

Claim ClaimOf(const BsmTruth& m, Timestamp begin) {
  Claim claim;
  claim.sent_s = ToSeconds(m.stamp - begin) - m.age_s;
  claim.p_W = m.claimed.p_W;
  claim.course_rad = WrapAngle(m.claimed.yaw_rad + (m.claimed.speed_mps < 0.0 ? kPi : 0.0));
  claim.speed_mps = std::abs(m.claimed.speed_mps);
  claim.box = {m.claimed.p_W, m.claimed.yaw_rad, m.claimed.length_m, m.claimed.width_m};
  return claim;
}

/// Constant velocity, one axis; both axes share the covariance.
class Kalman {
 public:
  /// Takes a claim in. @return its innovations, position and velocity, as lengths.
  std::pair<double, double> Step(const Claim& claim, double dt_s) {
    const Eigen::Vector2d velocity =
        claim.speed_mps * Eigen::Vector2d(std::cos(claim.course_rad), std::sin(claim.course_rad));
    p_ += dt_s * v_;
    // Random acceleration of 3 m/s^2, the sharpest the other checks believe.
    constexpr double kAccel = 3.0;
    const double q = kAccel * kAccel * dt_s;
    pp_ += 2.0 * dt_s * pv_ + dt_s * dt_s * vv_ + q * dt_s * dt_s / 3.0;
    pv_ += dt_s * vv_ + q * dt_s / 2.0;
    vv_ += q;
    const Eigen::Vector2d dp = claim.p_W - p_, dv = velocity - v_;
    // Both are measured, so the gain is P (P + R)^-1 with a 2 x 2 inverse.
    const double a = pp_ + kPosition_m2, b = pv_, d = vv_ + kSpeed_m2ps2;
    const double det = a * d - b * b;
    const double k11 = (pp_ * d - pv_ * b) / det, k12 = (pv_ * a - pp_ * b) / det;
    const double k21 = (pv_ * d - vv_ * b) / det, k22 = (vv_ * a - pv_ * b) / det;
    p_ += k11 * dp + k12 * dv;
    v_ += k21 * dp + k22 * dv;
    const double pp = pp_, pv = pv_, vv = vv_;
    pp_ = pp - k11 * pp - k12 * pv;
    pv_ = pv - k11 * pv - k12 * vv;
    vv_ = vv - k21 * pv - k22 * vv;
    return {dp.norm(), dv.norm()};
  }

  void Start(const Claim& claim) {
    p_ = claim.p_W;
    v_ = claim.speed_mps * Eigen::Vector2d(std::cos(claim.course_rad), std::sin(claim.course_rad));
    pp_ = kPosition_m2;
    pv_ = 0.0;
    vv_ = kSpeed_m2ps2;
  }

 private:
  static constexpr double kPosition_m2 = 4.0;   // A receiver of 2 m.
  static constexpr double kSpeed_m2ps2 = 0.25;  // ... and 0.5 m/s.
  Eigen::Vector2d p_ = Eigen::Vector2d::Zero(), v_ = Eigen::Vector2d::Zero();
  double pp_ = 0.0, pv_ = 0.0, vv_ = 0.0;
};

struct Sender {
  std::deque<Claim> recent;  // Within the heading window and the one before.
  std::optional<double> last_heard_s;
  Kalman kalman;
  double timer = 0.0;
};

/// The newest claim of every sender, by place.
class Neighbours {
 public:
  explicit Neighbours(const MessageCheckSettings& settings) : settings_(settings) {}

  [[nodiscard]] bool Intersects(std::uint32_t sender, const Claim& claim, double now_s) const {
    const Cell home = CellOf(claim.p_W);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto cell = cells_.find({home.first + dx, home.second + dy});
        if (cell == cells_.end()) continue;
        for (const auto& [other, entry] : cell->second) {
          if (other == sender) continue;
          const double weight = 1.0 - (now_s - entry.heard_s) / settings_.overlap_s;
          if (weight <= settings_.overlap_share) continue;
          if (OverlapShare(claim.box, entry.box) * weight > settings_.overlap_share) return true;
        }
      }
    }
    return false;
  }

  void Keep(std::uint32_t sender, const Claim& claim, double now_s) {
    const Cell cell = CellOf(claim.p_W);
    const auto [home, is_new] = homes_.try_emplace(sender, cell);
    if (!is_new && home->second != cell) cells_[home->second].erase(sender);
    home->second = cell;
    auto& entries = cells_[cell];
    // A flood of one-message ids must not make every later look slower.
    if (entries.size() >= 64) {
      std::erase_if(entries,
                    [&](const auto& e) { return now_s - e.second.heard_s > settings_.overlap_s; });
    }
    entries[sender] = {now_s, claim.box};
  }

 private:
  using Cell = std::pair<int, int>;
  struct Entry {
    double heard_s = 0.0;
    Footprint box;
  };
  static Cell CellOf(const Eigen::Vector2d& p_W) {
    constexpr double kCell_m = 20.0;
    const auto index = [](double v) {
      return static_cast<int>(std::floor(std::clamp(v, -1e6, 1e6) / kCell_m));
    };
    return {index(p_W.x()), index(p_W.y())};
  }

  const MessageCheckSettings& settings_;
  std::map<Cell, std::map<std::uint32_t, Entry>> cells_;
  std::map<std::uint32_t, Cell> homes_;
};

bool ContradictsItself(const Claim& before, const Claim& now, const MessageCheckSettings& s) {
  const double dt_s = now.sent_s - before.sent_s;
  if (dt_s <= 0.0 || dt_s > s.window_s) return false;
  const double gain = now.speed_mps - before.speed_mps;
  if (gain > s.accel_mps2 * dt_s || -gain > s.decel_mps2 * dt_s) return true;
  const double moved_m = (now.p_W - before.p_W).norm();
  const double fast = std::max(now.speed_mps, before.speed_mps);
  const double slow = std::min(now.speed_mps, before.speed_mps);
  const double most_m = fast * dt_s + 0.5 * s.accel_mps2 * dt_s * dt_s;
  const double least_m = std::max(0.0, slow * dt_s - 0.5 * s.decel_mps2 * dt_s * dt_s);
  const double margin_down_m = s.margin_down_a + s.margin_down_b * now.speed_mps +
                               s.margin_down_c * now.speed_mps * now.speed_mps;
  return moved_m > most_m + s.margin_up_m ||
         moved_m < least_m - std::max(s.margin_up_m, margin_down_m);
}

bool TravelsOffItsHeading(const std::deque<Claim>& recent, const Claim& now,
                          const MessageCheckSettings& s) {
  for (const Claim& before : recent) {
    const double dt_s = now.sent_s - before.sent_s;
    if (dt_s <= 0.0 || dt_s > s.heading_window_s) continue;
    const Eigen::Vector2d moved = now.p_W - before.p_W;
    if (moved.norm() < s.heading_from_m) return false;  // The oldest one has moved furthest.
    const double course = std::atan2(moved.y(), moved.x());
    return std::abs(AngleDifference(course, now.course_rad)) > s.heading_rad;
  }
  return false;
}

class Checker {
 public:
  Checker(const RunLog& log, const MessageCheckSettings& settings)
      : log_(log), settings_(settings), neighbours_(settings) {}

  bool Take(const BsmTruth& m) {
    if (!m.claimed.p_W.allFinite() || !std::isfinite(m.claimed.speed_mps)) return true;
    const Claim claim = ClaimOf(m, log_.truth.begin());
    const double now_s = ToSeconds(m.stamp - log_.truth.begin());
    Sender& sender = senders_[m.sender];
    const bool fails = Fails(m, claim, now_s, sender);
    neighbours_.Keep(m.sender, claim, now_s);
    if (!IsOvertaken(sender, claim)) {
      sender.recent.push_back(claim);
      while (sender.recent.size() > 1 &&
             claim.sent_s - sender.recent.front().sent_s > settings_.heading_window_s) {
        sender.recent.pop_front();
      }
    }
    sender.last_heard_s = now_s;
    const double worst_factor = fails ? 0.0 : 1.0;
    sender.timer +=
        settings_.timer_gain * std::exp(settings_.timer_steepness * (1.0 - worst_factor));
    const bool is_alarmed = sender.timer > settings_.timer_alarm;
    sender.timer = std::max(0.0, sender.timer - 1.0);
    return is_alarmed;
  }

 private:
  bool Fails(const BsmTruth& m, const Claim& claim, double now_s, Sender& sender) const {
    const MessageCheckSettings& s = settings_;
    const auto ego = log_.truth.ego.At(m.stamp);
    const double range_m = ego ? (claim.p_W - ego->position()).norm() : 0.0;
    bool fails = range_m > s.range_m || claim.speed_mps > s.speed_mps;
    const bool appears = !sender.last_heard_s || now_s - *sender.last_heard_s > s.appearance_s;
    if (appears) fails |= range_m < s.appearance_m;
    fails |= neighbours_.Intersects(m.sender, claim, now_s);
    if (sender.recent.empty()) {
      sender.kalman.Start(claim);
      return fails;
    }
    // The radio lets one message in forty overtake another: that is no lie.
    if (IsOvertaken(sender, claim)) return fails;
    const Claim& before = sender.recent.back();
    const double dt_s = claim.sent_s - before.sent_s;
    fails |= dt_s < -s.disorder_s;
    fails |= ContradictsItself(before, claim, s);
    fails |= TravelsOffItsHeading(sender.recent, claim, s);
    fails |= dt_s < s.beacon_share * s.beacon_s - kRounding_s;
    if (dt_s <= 0.0 || dt_s > s.window_s) {
      sender.kalman.Start(claim);
      return fails;
    }
    const auto [position_m, speed_mps] = sender.kalman.Step(claim, dt_s);
    return fails || position_m > s.kalman_m || speed_mps > s.kalman_mps;
  }

  bool IsOvertaken(const Sender& sender, const Claim& claim) const {
    if (sender.recent.empty()) return false;
    const double dt_s = claim.sent_s - sender.recent.back().sent_s;
    return dt_s < -kRounding_s && dt_s >= -settings_.disorder_s;
  }

  static constexpr double kRounding_s = 0.002;  // secMark counts milliseconds.
  const RunLog& log_;
  const MessageCheckSettings& settings_;
  Neighbours neighbours_;
  std::map<std::uint32_t, Sender> senders_;
};

}  // namespace

std::vector<bool> CheckMessages(const RunLog& log, const MessageCheckSettings& settings) {
  std::vector<bool> is_flagged(log.bsm_truths.size(), false);
  if (log.truth.empty()) return is_flagged;
  Checker checker(log, settings);
  for (std::size_t i = 0; i < is_flagged.size(); ++i)
    is_flagged[i] = checker.Take(log.bsm_truths[i]);
  return is_flagged;
}

}  // namespace v2vouch::evaluation
