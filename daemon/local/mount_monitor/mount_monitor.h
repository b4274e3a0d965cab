// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/mount_monitor/mount_monitor_config.h"
#include "daemon/local/odometry/odometry.h"

namespace v2vouch {

/// What the last full window of one radar's static returns said of its yaw.
struct MountVerdict {
  Timestamp stamp{};  ///< End of that window; Timestamp{}: there was none yet.
  /// To be added to the configured yaw, left positive: bearing in B = azimuth + yaw. NaN: no
  /// window.
  double yaw_correction_rad = kNaN;
  double yaw_sigma_rad = kNaN;
  int windows = 0;         ///< So far.
  int suspicious_run = 0;  ///< Windows running that said "moved", to the same side.
  bool has_moved = false;  ///< alarm_windows of them: measure the mount, calibrate again.
  double driven_s = 0.0;   ///< Of the window that is being filled.
};

/// Whether radars still sit as configured, from their static returns and the ego's motion alone; no
/// V2V message and no GNSS can move it, and nothing is done with what it says. For a return at
/// azimuth a of a standing object, with the antenna's velocity v_R in the radar's axes
/// (preprocessing/radar, MotionOfAntenna), the Doppler that is left over is
///
///     e(delta, s, a) = range_rate + (1 + s) v_R . u(a + delta),     u(a) = [cos a, sin a]
///
/// delta: the yaw to add; s: the odometer's scale error. Azimuth and Doppler both carry noise, so
/// each return's own azimuth error eta is solved for first (errors in variables; without it delta
/// is biased by 0.02 to 0.07 deg on a corner radar):
///
///     eta = argmin e(a + eta)^2 / sigma_D^2 + eta^2 / sigma_a^2
///     z = -(e - e_a eta) + e_a delta + e_s s,   variance sigma_D^2 + e_a^2 sigma_a^2
///
/// both with the running estimate, and z goes into one 2 x 2 least squares per block of a window,
/// weighted by Cauchy's function, and gated at 4 sigma against what moves. The sigma is that of the
/// blocks' scatter where it is larger than the formal one, and never below floor.
/// Constant memory, a function of what it is given in that order.
class MountMonitor {
 public:
  MountMonitor(const MountMonitorConfig& config, const VehicleConfig& vehicle);

  void OnEgoMotion(const EgoMotion& sample) { odometry_.OnEgoMotion(sample); }
  /// A scan that perception has taken.
  void OnRadarScan(const RadarScan& scan);
  /// Message time starts again; half-filled windows are forgotten, verdicts stay.
  void Restart();

  /// One per configured radar.
  [[nodiscard]] const std::vector<MountVerdict>& verdicts() const { return verdicts_; }

 private:
  static constexpr std::size_t kBlocks = 12;  // Of a window, whose scatter is looked at.

  struct Normal {
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();  // Information of (delta, s) ...
    Eigen::Vector2d y = Eigen::Vector2d::Zero();  // ... and H times their estimate.
    int returns = 0;
  };
  struct Window {
    std::array<Normal, kBlocks> blocks{};
    double driven_s = 0.0;
    Eigen::Vector2d running = Eigen::Vector2d::Zero();  // Estimate that returns are linearised at,
    Eigen::Matrix2d doubt = Eigen::Matrix2d::Zero();    // and its covariance.
    std::optional<Timestamp> last;
  };

  static void Add(const RadarDetection& detection, const RadarConfig& radar,
                  const Eigen::Vector2d& velocity_R, const Window& window, Normal& block);
  [[nodiscard]] Window NewWindow() const;
  [[nodiscard]] Normal Total(const Window& window) const;
  void Close(const Window& window, Timestamp stamp, MountVerdict& verdict) const;

  MountMonitorConfig config_;
  std::vector<RadarConfig> radars_;
  EgoOdometry odometry_;
  std::vector<Window> windows_;
  std::vector<MountVerdict> verdicts_;
};

}  // namespace v2vouch
