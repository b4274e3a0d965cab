// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/daemon_log.h"

#include <spdlog/spdlog.h>

#include "daemon/common/base/angle.h"
#include "daemon/rim/engine/calibration_in_force.h"

namespace v2vouch {
namespace {

constexpr int kMostRefusalLines = 20;  // Per second.

void LogCalibration(const DaemonConfig& config) {
  const auto count = [&config](CalibrationVerdict verdict) {
    return CountVerdicts(config, verdict);
  };
  spdlog::info(
      "event=calibration source=\"{}\" estimated={} weak={} prior={} at_bound={} rejected={}",
      CalibrationTitle(config), count(CalibrationVerdict::kEstimated),
      count(CalibrationVerdict::kWeak), count(CalibrationVerdict::kPrior),
      count(CalibrationVerdict::kAtBound), count(CalibrationVerdict::kRejected));
}

}  // namespace

void DaemonLog::Start(const DaemonConfig& config, std::size_t inputs,
                      const std::vector<int>& ports) {
  spdlog::info("event=started version={} inputs={}", V2VOUCH_VERSION, inputs);
  if (ports.size() == 2 && ports[0] == ports[1] && ports[0] != 0) {
    spdlog::warn(
        "event=v2v_url_shares_port port={} hint=\"another group on the same port separates "
        "nothing; "
        "give BSMs a port of their own\"",
        ports[0]);
  }
  LogCalibration(config);
}

void DaemonLog::Refusals(const std::vector<RefusalTable::Row>& rows) {
  logged_.resize(rows.size(), 0);
  int lines = 0;
  for (std::size_t n = 0; n < rows.size() && lines < kMostRefusalLines; ++n) {
    const std::size_t i = next_refusal_ % rows.size();
    ++next_refusal_;
    const RefusalTable::Row& row = rows[i];
    if (row.count == logged_[i]) continue;
    spdlog::warn("event=refused channel={} reason={} field=\"{}\" count={} total={}", row.channel,
                 ReasonName(row.refusal.reason), row.FieldText(), row.count - logged_[i],
                 row.count);
    logged_[i] = row.count;
    ++lines;
  }
}

void DaemonLog::QueueDrops(std::int64_t own, std::int64_t bsm) {
  if (own + bsm == logged_drops_) return;
  spdlog::warn("event=queue_full own={} bsm={}", own, bsm);
  logged_drops_ = own + bsm;
}

void DaemonLog::Mounts(const std::vector<RadarConfig>& radars,
                       std::span<const MountVerdict> mounts) {
  moved_.resize(radars.size(), false);
  for (std::size_t i = 0; i < radars.size(); ++i) {
    const MountVerdict& mount = mounts[i];
    if (mount.has_moved == moved_[i]) continue;
    moved_[i] = mount.has_moved;
    const double correction_deg = ToDegrees(mount.yaw_correction_rad);
    const double sigma_deg = ToDegrees(mount.yaw_sigma_rad);
    if (mount.has_moved) {
      spdlog::warn(
          "event=mount_moved sensor=radar_{} yaw_correction_deg={:.2f} sigma_deg={:.2f} "
          "hint=\"check the mount and calibrate again\"",
          LowerCaseName(radars[i].name), correction_deg, sigma_deg);
    } else {
      spdlog::info("event=mount_right sensor=radar_{} yaw_correction_deg={:.2f} sigma_deg={:.2f}",
                   LowerCaseName(radars[i].name), correction_deg, sigma_deg);
    }
  }
}

void DaemonLog::Notices(const std::vector<NoticeBoard::Change>& changes) {
  for (const NoticeBoard::Change& change : changes) {
    const wire::NoticeStatus& notice = change.notice;
    if (change.has_begun) {
      spdlog::warn("event={} channel={} value={:.3f} hint=\"{}\"", notice.name, notice.channel,
                   notice.value, notice.advice);
    } else {
      spdlog::info("event={}_ended channel={}", notice.name, notice.channel);
    }
  }
}

void DaemonLog::Waiting(std::size_t index, const Receiver& bus, const std::string& url) {
  int& reported = reported_failures_[index];
  const int failures = bus.failures();
  if (bus.is_open() || failures == 0 || failures == reported) return;
  spdlog::warn("event=no_lcm url=\"{}\" attempt={} hint=\"is there a multicast route?\"", url,
               failures);
  reported = failures;
}

}  // namespace v2vouch
