// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/mount_monitor/mount_monitor.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "daemon/local/radar/radar_preprocessing.h"

namespace v2vouch {
namespace {

constexpr double kGate_sigmas = 4.0;
constexpr double kCauchy = 2.385;       // 95 % efficient for a normal distribution.
constexpr int kAzimuthSteps = 3;        // Of Gauss-Newton for one return; it converges in two.
constexpr double kLongestStep_s = 0.2;  // Longer, the radar was silent: no driving is counted.
constexpr double kYawPrior_rad = FromDegrees(2.0);  // Where a window starts to look.
constexpr int kLeastReturns = 200;                  // Of a window that may say anything.

}  // namespace

MountMonitor::MountMonitor(const MountMonitorConfig& config, const VehicleConfig& vehicle)
    : config_(config),
      radars_(vehicle.radars),
      windows_(vehicle.radars.size(), NewWindow()),
      verdicts_(vehicle.radars.size()) {}

MountMonitor::Window MountMonitor::NewWindow() const {
  Window window;
  window.doubt = Total(window).H.inverse();
  return window;
}

void MountMonitor::Restart() {
  odometry_ = EgoOdometry();
  windows_.assign(windows_.size(), NewWindow());
  for (MountVerdict& verdict : verdicts_) verdict.driven_s = 0.0;
}

void MountMonitor::OnRadarScan(const RadarScan& scan) {
  if (!config_.enabled) return;
  const auto index = static_cast<std::size_t>(scan.radar);
  Window& window = windows_[index];
  const auto ego = odometry_.StateAt(scan.stamp);
  const double step_s = window.last ? ToSeconds(scan.stamp - *window.last) : 0.0;
  if (step_s < 0.0) return;  // Late: its place in the window is gone.
  window.last = scan.stamp;
  if (!ego || std::abs(ego->speed_mps) < config_.min_speed_mps) return;

  const double share = window.driven_s / config_.window_s;
  const auto block = std::min(static_cast<std::size_t>(share * kBlocks), kBlocks - 1);
  const Eigen::Vector2d velocity_R = MotionOfAntenna(radars_[index], *ego).velocity_R;
  for (const RadarDetection& detection : scan.detections) {
    Add(detection, radars_[index], velocity_R, window, window.blocks[block]);
  }
  const Normal so_far = Total(window);
  window.doubt = so_far.H.inverse();
  window.running = window.doubt * so_far.y;
  window.driven_s += std::min(step_s, kLongestStep_s);

  MountVerdict& verdict = verdicts_[index];
  if (window.driven_s >= config_.window_s) {
    Close(window, scan.stamp, verdict);
    // The next window is linearised at what this one found from its first return on.
    const Eigen::Vector2d running = window.running;
    window = NewWindow();
    window.running = running;
    window.last = scan.stamp;
  }
  verdict.driven_s = window.driven_s;
}

void MountMonitor::Add(const RadarDetection& detection, const RadarConfig& radar,
                       const Eigen::Vector2d& velocity_R, const Window& window, Normal& block) {
  if (detection.range_m < radar.min_range_m || detection.range_m > radar.max_range_m) return;
  const double doppler_variance = radar.range_rate_sigma_mps * radar.range_rate_sigma_mps;
  const double azimuth_variance = radar.azimuth_sigma_rad * radar.azimuth_sigma_rad;
  double eta = 0.0;
  double along = 0.0;  // v_R . u, and its derivative by the azimuth.
  double across = 0.0;
  double e = 0.0;
  double slope = 0.0;
  for (int step = 0;; ++step) {
    const double angle = detection.azimuth_rad + window.running[0] + eta;
    along = velocity_R.x() * std::cos(angle) + velocity_R.y() * std::sin(angle);
    across = -velocity_R.x() * std::sin(angle) + velocity_R.y() * std::cos(angle);
    e = detection.range_rate_mps + (1.0 + window.running[1]) * along;
    slope = (1.0 + window.running[1]) * across;
    if (step == kAzimuthSteps) break;
    // Minimum of (e + slope d)^2 / sigma_D^2 + (eta + d)^2 / sigma_a^2.
    eta = -azimuth_variance * slope * (e - slope * eta) /
          (doppler_variance + slope * slope * azimuth_variance);
  }
  const Eigen::Vector2d h(slope, along);
  const double variance = doppler_variance + slope * slope * azimuth_variance;
  const double residual = e - slope * eta;
  // What moves is out. The gate knows how little is known yet, or a mount that has turned would
  // shut its own evidence out.
  const double gate = kGate_sigmas * kGate_sigmas * (variance + h.dot(window.doubt * h));
  if (!(residual * residual <= gate)) return;  // Nor is what is not finite taken.
  const double squared_sigmas = residual * residual / variance;
  const double weight = 1.0 / (1.0 + squared_sigmas / (kCauchy * kCauchy)) / variance;
  block.H += weight * h * h.transpose();
  block.y += weight * (h.dot(window.running) - residual) * h;
  ++block.returns;
}

// All blocks and the prior of the scale.
MountMonitor::Normal MountMonitor::Total(const Window& window) const {
  Normal total;
  total.H.diagonal() << 1.0 / (kYawPrior_rad * kYawPrior_rad),
      1.0 / (config_.speed_scale_sigma * config_.speed_scale_sigma);
  for (const Normal& block : window.blocks) {
    total.H += block.H;
    total.y += block.y;
    total.returns += block.returns;
  }
  return total;
}

void MountMonitor::Close(const Window& window, Timestamp stamp, MountVerdict& verdict) const {
  const Normal total = Total(window);
  if (total.returns < kLeastReturns) return;
  const Eigen::Matrix2d P = total.H.inverse();
  const Eigen::Vector2d estimate = P * total.y;
  // Scatter of the blocks about the common estimate: (y - H x)' H^-1 (y - H x) is chi-square with
  // 2 degrees of freedom for each where noise is white.
  double squares = 0.0;
  double freedom = -2.0;
  for (const Normal& block : window.blocks) {
    const Eigen::LLT<Eigen::Matrix2d> factor(block.H);
    if (block.returns == 0 || factor.info() != Eigen::Success) continue;
    const Eigen::Vector2d off = block.y - block.H * estimate;
    squares += off.dot(factor.solve(off));
    freedom += 2.0;
  }
  const double inflation = freedom > 0.0 ? std::max(1.0, squares / freedom) : 1.0;
  const double sigma_rad = std::sqrt(inflation * P(0, 0) + config_.floor_rad * config_.floor_rad);
  if (!std::isfinite(estimate[0]) || !std::isfinite(sigma_rad)) return;

  const bool is_suspicious = std::abs(estimate[0]) > config_.alarm_rad &&
                             std::abs(estimate[0]) > config_.alarm_sigmas * sigma_rad;
  const bool is_same_side = verdict.yaw_correction_rad * estimate[0] > 0.0;
  verdict.suspicious_run = !is_suspicious ? 0 : (is_same_side ? verdict.suspicious_run : 0) + 1;
  verdict.has_moved = verdict.suspicious_run >= config_.alarm_windows;
  verdict.stamp = stamp;
  verdict.yaw_correction_rad = estimate[0];
  verdict.yaw_sigma_rad = sigma_rad;
  ++verdict.windows;
}

}  // namespace v2vouch
