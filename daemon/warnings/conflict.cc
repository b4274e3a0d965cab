// SPDX-License-Identifier: Apache-2.0
#include "daemon/warnings/conflict.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace v2vouch::warnings {
namespace {

using State6 = Eigen::Matrix<double, kStateSize, 1>;

// A square root that exists for any symmetric matrix: negative eigenvalues count as zero.
StateMatrix SquareRoot(const StateMatrix& covariance) {
  const Eigen::SelfAdjointEigenSolver<StateMatrix> solver(covariance);
  const State6 root = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return solver.eigenvectors() * root.asDiagonal();
}

double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return kNaN;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

bool KeepsBraking(const BodyTarget& target) {
  const double sigma = std::sqrt(std::max(0.0, target.covariance(kAccel, kAccel)));
  return target.mean[kSpeed] > 0.5 && target.mean[kAccel] + sigma < -1.0;
}

// Whether the two could come near each other at all: the mean motions with all that the draws may
// add. A cheap no for most vehicles.
bool CouldMeet(const Motion& ego, const HalfSize& ego_size, const Motion& other,
               const BodyTarget& target) {
  const auto sigma = [&target](int i) { return std::sqrt(std::max(0.0, target.covariance(i, i))); };
  const double at_once_m = 3.0 * std::hypot(sigma(kX), sigma(kY)) + 1.0;
  const double speed = std::abs(target.mean[kSpeed]);
  const double per_s = 3.0 * (sigma(kSpeed) + speed * sigma(kYaw)) + 0.3;
  const double per_s2 = 1.5 * (sigma(kAccel) + speed * sigma(kYawRate)) + 0.1;
  for (std::size_t k = 0; k < other.size(); ++k) {
    const double t_s = kStep_s * static_cast<double>(k);
    const double reach_m = ego_size.radius_m() + target.size.radius_m() + at_once_m + per_s * t_s +
                           per_s2 * t_s * std::min(t_s, 3.0);
    if ((ego[k].centre - other[k].centre).squaredNorm() < reach_m * reach_m) return true;
  }
  return false;
}

// Whether the rectangles round two motions come within `reach_m` of each other.
bool BoundsMeet(const Motion& a, const Motion& b, double reach_m) {
  const auto bounds = [](const Motion& motion) {
    std::pair<Eigen::Array2d, Eigen::Array2d> out{motion[0].centre, motion[0].centre};
    for (const Box& box : motion) {
      out.first = out.first.min(box.centre.array());
      out.second = out.second.max(box.centre.array());
    }
    return out;
  };
  const auto in_a = bounds(a);
  const auto in_b = bounds(b);
  return (in_a.first - reach_m <= in_b.second).all() && (in_b.first - reach_m <= in_a.second).all();
}

// First touches over the draws.
struct Touches {
  std::vector<double> wide_s;
  std::vector<double> exact_s;
  double reachable_s = kNaN;
};

constexpr std::size_t kLanes = TargetLanes::kLanes;
static_assert(kDrawCount % kLanes == 0);

// Eight draws: one step of all, then the next, until all have touched or none can any more.
class DrawBlock {
 public:
  DrawBlock(const EgoFan& ego, const BodyTarget& target, const StateMatrix& root,
            bool keeps_braking, std::size_t first)
      : ego_(ego), size_(target.size), lanes_(States(target, root, first), keeps_braking) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Draw& draw = NormalDraws()[first + i];
      own_[i] = &ego.Of(draw[6], draw[7]);
      spread_[i] = Eigen::Map<const State6>(draw.data()).squaredNorm();
    }
  }

  void Run(double near, Touches& touches) {
    const double far_m = ego_.wide().radius_m() + size_.radius_m();
    const double far_m2 = far_m * far_m;
    const auto steps = static_cast<std::size_t>(ego_.steps());
    for (std::size_t k = 0; k <= steps && open_ > 0; ++k) {
      TargetLanes::Row m2;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const Eigen::Vector2d& own = (*own_[i])[k].centre;
        const double dx = own.x() - lanes_.x_m()[i];
        const double dy = own.y() - lanes_.y_m()[i];
        m2[i] = dx * dx + dy * dy;
      }
      for (std::size_t i = 0; i < kLanes; ++i) {
        if (m2[i] <= far_m2 && !is_done_[i]) Try(i, k, near, touches);
      }
      // Now and then: can any of them still come near?
      if (k % 8 == 4 && !CanMeet(m2, steps - k, far_m)) return;
      lanes_.Step();
    }
  }

 private:
  static std::array<StateVector, kLanes> States(const BodyTarget& target, const StateMatrix& root,
                                                std::size_t first) {
    std::array<StateVector, kLanes> states;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const State6 z = Eigen::Map<const State6>(NormalDraws()[first + i].data());
      states[i] = target.mean + root * z;
    }
    return states;
  }

  void Try(std::size_t i, std::size_t k, double near, Touches& touches) {
    const Box& own = (*own_[i])[k];
    const Box other = lanes_.At(i);
    if (!Touch(own, ego_.wide(), other, size_)) return;
    const double t_s = kStep_s * static_cast<double>(k);
    if (!has_touched_[i]) {
      has_touched_[i] = true;
      touches.wide_s.push_back(t_s);
      if (spread_[i] <= near && !(touches.reachable_s <= t_s)) touches.reachable_s = t_s;
    }
    if (!Touch(own, ego_.exact(), other, size_)) return;
    touches.exact_s.push_back(t_s);
    is_done_[i] = true;
    --open_;
  }

  [[nodiscard]] bool CanMeet(const TargetLanes::Row& m2, std::size_t steps_left,
                             double far_m) const {
    const double time_s = kStep_s * static_cast<double>(steps_left);
    const double reach_m = far_m + 1e-6 + lanes_.FurthestIn(time_s) +
                           ego_.longest_step_m() * static_cast<double>(steps_left);
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (!is_done_[i]) nearest_m2 = std::min(nearest_m2, m2[i]);
    }
    return nearest_m2 <= reach_m * reach_m;
  }

  const EgoFan& ego_;
  const HalfSize& size_;
  TargetLanes lanes_;
  std::array<const Motion*, kLanes> own_{};
  TargetLanes::Row spread_{};
  std::array<bool, kLanes> has_touched_{};
  std::array<bool, kLanes> is_done_{};
  int open_ = static_cast<int>(kLanes);
};

void TakeDraws(const EgoFan& ego, const BodyTarget& target, bool keeps_braking,
               const WarningsConfig& config, Touches& touches) {
  const StateMatrix root = SquareRoot(target.covariance);
  const double near = config.hidden_sigmas * config.hidden_sigmas;
  touches.wide_s.reserve(kDrawCount);
  touches.exact_s.reserve(kDrawCount);
  for (std::size_t first = 0; first < kDrawCount; first += kLanes) {
    DrawBlock(ego, target, root, keeps_braking, first).Run(near, touches);
  }
}

}  // namespace

void AssessGap(const Motion& ego, const HalfSize& ego_size, const Motion& other,
               const HalfSize& other_size, Conflict& conflict) {
  const double radii_m = ego_size.radius_m() + other_size.radius_m();
  if (!BoundsMeet(ego, other, radii_m)) return;
  double best_s = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ego.size(); ++i) {
    for (std::size_t j = 0; j < other.size(); ++j) {
      const Eigen::Vector2d between = other[j].centre - ego[i].centre;
      const double far_m = std::max(std::abs(between.x()), std::abs(between.y())) - radii_m;
      if (far_m > 0.0) {
        // Not before the other one has come that much nearer.
        const double step_m =
            j + 1 < other.size() ? (other[j + 1].centre - other[j].centre).norm() : far_m;
        if (step_m < 1e-6) break;
        continue;
      }
      if (!Touch(ego[i], ego_size, other[j], other_size)) continue;
      const double t_ego = kStep_s * static_cast<double>(i);
      const double t_other = kStep_s * static_cast<double>(j);
      if (std::isnan(conflict.ego_enters_s)) conflict.ego_enters_s = t_ego;
      if (!(conflict.other_enters_s <= t_other)) conflict.other_enters_s = t_other;
      if (std::abs(t_ego - t_other) < best_s - 1e-9) {
        best_s = std::abs(t_ego - t_other);
        conflict.place_B = ego[i].centre;
      }
    }
  }
  if (std::isfinite(best_s)) conflict.post_encroachment_s = best_s;
}

EgoFan::EgoFan(const EgoPlan& plan, const EgoSigmas& sigmas, const EgoBody& body,
               const WarningsConfig& config)
    : exact_{0.5 * body.length_m, 0.5 * body.width_m},
      wide_{exact_.length_m + config.body_margin_m, exact_.width_m + config.body_margin_m} {
  const int steps = static_cast<int>(std::lround(config.horizon_s / kStep_s));
  PredictEgo(plan, body, steps, mean_);
  constexpr std::array<double, 5> kSpread = {-1.4, -0.53, 0.0, 0.53, 1.4};  // Means of fifths.
  for (std::size_t i = 0; i < fan_.size(); ++i) {
    EgoPlan each = plan;
    if (plan.speed_mps > 0.1) {
      each.speed_mps = std::max(0.1, plan.speed_mps + kSpread[i / 5] * sigmas.speed_mps);
    }
    const double by = kSpread[i % 5] * sigmas.yaw_rate_radps / std::max(3.0, plan.speed_mps);
    each.curvature_per_m += by;
    PredictEgo(each, body, steps, fan_[i]);
    for (std::size_t k = 1; k < fan_[i].size(); ++k) {
      const double step_m = (fan_[i][k].centre - fan_[i][k - 1].centre).norm();
      longest_step_m_ = std::max(longest_step_m_, step_m);
    }
  }
}

const Motion& EgoFan::Of(double z_speed, double z_yaw_rate) const {
  const auto fifth = [](double z) {
    return z < -0.8416 ? 0u : z < -0.2533 ? 1u : z < 0.2533 ? 2u : z < 0.8416 ? 3u : 4u;
  };
  return fan_[5 * fifth(z_speed) + fifth(z_yaw_rate)];
}

Conflict AssessConflict(const EgoFan& ego, const BodyTarget& target, const WarningsConfig& config) {
  const int steps = ego.steps();
  const HalfSize& wide = ego.wide();
  Conflict conflict;
  const bool keeps_braking = KeepsBraking(target);
  const Motion& mean_ego = ego.mean();
  Motion mean_other;
  PredictTarget(target.mean, keeps_braking, steps, mean_other);
  if (std::abs(target.mean[kSpeed]) > 0.5) {
    AssessGap(mean_ego, wide, mean_other, target.size, conflict);
  }
  if (!CouldMeet(mean_ego, wide, mean_other, target)) return conflict;
  Touches touches;
  TakeDraws(ego, target, keeps_braking, config, touches);
  conflict.reachable_s = touches.reachable_s;
  conflict.probability = static_cast<double>(touches.wide_s.size()) / kDrawCount;
  conflict.probability_exact = static_cast<double>(touches.exact_s.size()) / kDrawCount;
  conflict.early_s = Quantile(touches.wide_s, 0.1);
  conflict.median_s = Quantile(touches.wide_s, 0.5);
  conflict.exact_median_s = Quantile(touches.exact_s, 0.5);
  if (conflict.place_B.hasNaN() && std::isfinite(conflict.median_s)) {
    conflict.place_B =
        mean_ego[static_cast<std::size_t>(std::lround(conflict.median_s / kStep_s))].centre;
  }
  return conflict;
}

}  // namespace v2vouch::warnings
