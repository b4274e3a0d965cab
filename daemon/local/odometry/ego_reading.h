// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/local/odometry/ego_reading_config.h"
#include "daemon/local/odometry/gyro_offset.h"
#include "daemon/local/odometry/speed_check.h"
#include "daemon/local/odometry/standing_world.h"
#include "daemon/local/odometry/yaw_check.h"

namespace v2vouch {

/// What EGO_MOTION means: the car's own motion as its sensors report it, checked against each other
/// and against the Doppler of the standing world, corrected where the fault is known. Own sensors
/// only, so LOCAL may use it. Copyable, fixed size; a function of inputs in order of time.
class EgoReading {
 public:
  explicit EgoReading(const EgoReadingConfig& config = {}) : config_(config) {}

  /// One sample. @return the same with speed, yaw rate and their sigma corrected.
  EgoMotion Read(const EgoMotion& sample);
  /// One radar scan. @return where it changed how the speed is read: since when that was misread.
  std::optional<Timestamp> OnRadarScan(const RadarScan& scan, const RadarConfig& radar);

  /// The newest sample as it came; to be read again where a scan changed its meaning.
  [[nodiscard]] const EgoMotion& newest() const { return newest_; }
  /// Adds what was learnt and corrected, where worth telling.
  void CollectNotices(std::vector<Notice>& notices) const;

  [[nodiscard]] const GyroOffset& gyro() const { return gyro_; }
  /// Unit and tyre size as corrected; 1 where they are not.
  [[nodiscard]] double speed_factor() const {
    return config_.check_speed ? std::abs(speed_.factor()) : 1.0;
  }
  [[nodiscard]] const SpeedCheck& speed() const { return speed_; }
  [[nodiscard]] const YawCheck& yaw() const { return yaw_; }

 private:
  EgoReadingConfig config_;
  GyroOffset gyro_;
  SpeedCheck speed_;
  YawCheck yaw_;
  EgoMotion newest_;
  double yaw_rate_radps_ = 0.0;
  struct Working : StandingWorld {  // Means nothing from one scan to the next.
    Working() = default;
    Working(const Working&) : StandingWorld() {}
    Working& operator=(const Working&) { return *this; }
  } world_;
};

}  // namespace v2vouch
