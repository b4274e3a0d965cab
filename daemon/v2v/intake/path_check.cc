// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/path_check.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kLongestSilence_s = 2.0;  // After it the path starts again.
constexpr double kLongestWindow_s = 5.0;   // Of the regression.
constexpr std::array<double, 6> kWindows_s{1.0, 1.5, 2.0, 3.0, 4.0, 4.9};
constexpr std::size_t kFewest = 6;  // Places: a broken line has three parameters.
constexpr double kScatter_m = 0.4;
constexpr double kScatter_s = 0.02;
constexpr double kMostScatter_m = 1.5;
constexpr double kMostScatter_s = 0.1;     // Positions of real senders are older than stamped.
constexpr double kIndependent_hz = 4.0;    // GNSS errors of places closer in time are alike.
constexpr double kUnseenAccel_mps2 = 1.0;  // What speed and course may do between two messages.
constexpr double kReverse_rad = FromDegrees(150.0);
constexpr double kReverseSpeed_mps = 6.0;
constexpr double kAccusation = 2.0;  // Times the limit.

// Sums over points (t, r); r is a vector.
struct Sums {
  double n = 0.0;
  double t = 0.0;
  double tt = 0.0;
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  Eigen::Vector2d tr = Eigen::Vector2d::Zero();
  double rr = 0.0;

  void Add(double time, const Eigen::Vector2d& value) {
    n += 1.0;
    t += time;
    tt += time * time;
    r += value;
    tr += time * value;
    rr += value.squaredNorm();
  }
  friend Sums operator-(Sums a, const Sums& b) {
    a.n -= b.n;
    a.t -= b.t;
    a.tt -= b.tt;
    a.r -= b.r;
    a.tr -= b.tr;
    a.rr -= b.rr;
    return a;
  }
  // About the means.
  [[nodiscard]] double Stt() const { return tt - t * t / n; }
  [[nodiscard]] Eigen::Vector2d Str() const { return tr - r * (t / n); }
  [[nodiscard]] double Srr() const { return rr - r.squaredNorm() / n; }
};

struct Line {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double variance = 0.0;  // Of the points about it, per axis.
  double Stt = 0.0;
};

Line Fit(double Stt, const Eigen::Vector2d& Str, double Srr, double freedom) {
  Line line;
  line.Stt = Stt;
  line.slope = Str / Stt;
  line.variance = std::max(0.0, Srr - Str.squaredNorm() / Stt) / (2.0 * freedom);
  return line;
}

// A line that breaks once, where that explains the points best: common slope, two levels.
std::optional<Line> FitBroken(const std::array<Sums, 65>& sums, std::size_t n) {
  std::optional<Line> best;
  for (std::size_t k = 2; k + 2 <= n; ++k) {
    const Sums& left = sums[k - 1];
    const Sums right = sums[n - 1] - left;
    const double Stt = left.Stt() + right.Stt();
    if (Stt <= 1e-6) continue;
    const Line line =
        Fit(Stt, left.Str() + right.Str(), left.Srr() + right.Srr(), static_cast<double>(n) - 3.0);
    if (!best || line.variance < best->variance) best = line;
  }
  return best;
}

// How far speed and course lie beyond their limits; 1 = at the limit.
struct Excess {
  double speed = 0.0;
  double speed_error_mps = 0.0;
  double speed_limit_mps = 0.0;
  double course = 0.0;
  double course_error_rad = 0.0;
  double course_limit_rad = 0.0;
  bool may_be_reverse = false;
};

Excess Compare(const Line& line, const Eigen::Vector2d& claimed_mps, double window_s, double n,
               double between, const PathStep& step, const MessageCheckConfig& config) {
  const Eigen::Vector2d made_good_mps = claimed_mps + line.slope;
  const double claimed = claimed_mps.norm();
  const double made_good = made_good_mps.norm();
  Excess excess;
  const double speed = std::min(claimed, made_good);
  const double most = std::max({kMostScatter_m, step.sigma_m, kMostScatter_s * speed});
  const double scatter =
      std::clamp(std::sqrt(line.variance), std::min(most, kScatter_m + kScatter_s * speed), most);
  const double independent = std::min(n, kIndependent_hz * window_s + 1.0);
  const double slope_sigma =
      std::hypot(scatter * std::sqrt(n / (independent * line.Stt)), between / window_s);
  const double slack_mps = config.path_noise_sigmas * slope_sigma;
  excess.speed_error_mps = std::abs(made_good - claimed);
  excess.speed_limit_mps = config.path_speed_mps + config.path_speed_share * claimed + slack_mps;
  excess.speed = excess.speed_error_mps / excess.speed_limit_mps;
  if (speed > config.path_min_speed_mps) {
    const double cross = claimed_mps.x() * made_good_mps.y() - claimed_mps.y() * made_good_mps.x();
    excess.course_error_rad = std::abs(std::atan2(cross, claimed_mps.dot(made_good_mps)));
    excess.course_limit_rad = config.path_course_rad + slack_mps / speed;
    excess.course = excess.course_error_rad / excess.course_limit_rad;
    excess.may_be_reverse = excess.course_error_rad > kReverse_rad && made_good < kReverseSpeed_mps;
  }
  return excess;
}

// What was claimed and made good over one window.
struct Window {
  const std::array<Sums, 65>& sums;
  std::size_t n;
  double span_s;
  Eigen::Vector2d claimed_mps;
  double between_m;
};

void RaiseExcess(const Window& window, const PathStep& step, const MessageCheckConfig& config,
                 Excess& speed, Excess& course) {
  const auto n = static_cast<double>(window.n);
  const auto compare = [&](const Line& line) {
    return Compare(line, window.claimed_mps, window.span_s, n, window.between_m, step, config);
  };
  const Sums& all = window.sums[window.n - 1];
  const Excess plain = compare(Fit(all.Stt(), all.Str(), all.Srr(), n - 2.0));
  if (plain.speed <= std::max(1.0, speed.speed) && plain.course <= std::max(1.0, course.course)) {
    return;
  }
  const auto broken_line = FitBroken(window.sums, window.n);
  if (!broken_line) return;
  const Excess broken = compare(*broken_line);
  const Excess& less_speed = broken.speed < plain.speed ? broken : plain;
  const Excess& less_course = broken.course < plain.course ? broken : plain;
  if (less_speed.speed > speed.speed) speed = less_speed;
  if (less_course.course > course.course) course = less_course;
}

// @param accuses_speed, accuses_course whether the excess has held for long enough.
std::optional<Finding> Conclude(const Excess& speed, const Excess& course, bool accuses_speed,
                                bool accuses_course) {
  const auto of_speed = [&] {
    const double times = accuses_speed ? kAccusation : 1.0;
    return Finding{Check::kSpeedAgainstPath, accuses_speed ? Verdict::kAccuse : Verdict::kWithdraw,
                   "speed_error_mps", speed.speed_error_mps, times * speed.speed_limit_mps};
  };
  const auto of_course = [&] {
    const double times = accuses_course ? kAccusation : 1.0;
    return Finding{Check::kCourseAgainstPath,
                   accuses_course ? Verdict::kAccuse : Verdict::kWithdraw, "course_error_rad",
                   course.course_error_rad, times * course.course_limit_rad};
  };
  if (std::max(speed.speed, course.course) <= 1.0) return std::nullopt;
  const bool is_course =
      accuses_speed != accuses_course ? accuses_course : course.course > speed.speed;
  return is_course ? of_course() : of_speed();
}

}  // namespace

Eigen::Vector2d ClaimedWay(double yaw_from_rad, double speed_from_mps, double yaw_to_rad,
                           double speed_to_mps, double dt_s) {
  const double half = 0.5 * AngleDifference(yaw_to_rad, yaw_from_rad);
  const double chord = std::abs(half) < 1e-4 ? 1.0 : std::sin(half) / half;
  const double way = 0.5 * (speed_from_mps + speed_to_mps) * dt_s * chord;
  return way * Eigen::Vector2d(std::cos(yaw_from_rad + half), std::sin(yaw_from_rad + half));
}

void PathCheck::Restart() {
  next_ = 0;
  count_ = 0;
  speed_held_s_ = 0.0;
  course_held_s_ = 0.0;
}

std::optional<Finding> PathCheck::Judge(const PathStep& step, const MessageCheckConfig& config) {
  if (!(step.dt_s > 0.0) || step.dt_s > kLongestSilence_s) {
    Restart();
    return std::nullopt;
  }
  const Eigen::Vector2d beyond = step.moved_m - step.claimed_m;
  steps_[next_] = {static_cast<float>(step.dt_s), static_cast<float>(beyond.x()),
                   static_cast<float>(beyond.y()), static_cast<float>(step.claimed_m.x()),
                   static_cast<float>(step.claimed_m.y())};
  next_ = (next_ + 1) % kSteps;
  count_ = std::min(count_ + 1, kSteps);

  // Backwards from now: both r and t are 0 at the newest place.
  std::array<Sums, kSteps + 1> sums;
  sums[0].Add(0.0, Eigen::Vector2d::Zero());
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  Eigen::Vector2d claimed = Eigen::Vector2d::Zero();
  double t = 0.0;
  double between = 0.0;
  std::size_t n = 1;
  std::size_t window = 0;
  Excess speed;
  Excess course;
  for (std::size_t back = 0; back < count_ && window < kWindows_s.size(); ++back) {
    const Stored& one = steps_[(next_ + kSteps - 1 - back) % kSteps];
    t -= one.dt_s;
    if (-t > kLongestWindow_s + 1e-3) break;
    r -= Eigen::Vector2d(one.excess_x_m, one.excess_y_m);
    claimed += Eigen::Vector2d(one.claimed_x_m, one.claimed_y_m);
    const double unseen = 0.5 * kUnseenAccel_mps2 * one.dt_s * one.dt_s;
    between += unseen * unseen;
    sums[n] = sums[n - 1];
    sums[n].Add(t, r);
    ++n;
    const double way = std::sqrt(std::max(claimed.squaredNorm(), (claimed - r).squaredNorm()));
    if (-t < kWindows_s[window] || n < kFewest || way < config.path_min_m) continue;
    while (window < kWindows_s.size() && -t >= kWindows_s[window]) ++window;

    RaiseExcess({sums, n, -t, claimed / -t, std::sqrt(between)}, step, config, speed, course);
  }

  speed_held_s_ = speed.speed > kAccusation ? speed_held_s_ + step.dt_s : 0.0;
  course_held_s_ =
      course.course > kAccusation && !course.may_be_reverse ? course_held_s_ + step.dt_s : 0.0;
  return Conclude(speed, course, speed_held_s_ >= config.accuse_hold_s,
                  course_held_s_ >= config.accuse_hold_s);
}

}  // namespace v2vouch
