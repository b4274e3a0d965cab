// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/import/imported_event.h"

namespace v2vouch::sim {

/// One drive of the comma2k19 collection (Toyota RAV4 with its factory radar), as CSV files:
/// radar_tracks.csv, ego_speed.csv, imu_fwd_right_down.csv, gnss_ublox.csv. All times are seconds
/// of one device clock ("boot time").
struct Comma2k19Segment {
  struct RadarRow {
    double t_s = 0.0;
    double long_m = 0.0;         ///< Forward, as in the file.
    double lat_m = 0.0;          ///< As in the file.
    double rel_speed_mps = 0.0;  ///< Range rate relative to the car, away positive.
    int slot = 0;                ///< CAN address of the sensor's track slot.
  };
  struct SpeedRow {
    double t_s = 0.0;
    double speed_mps = 0.0;
  };
  struct GyroRow {
    double t_s = 0.0;
    double down_radps = 0.0;  ///< About the device's down axis: right turn positive.
  };
  struct FixRow {
    double t_s = 0.0;  ///< When it came out of the receiver.
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double speed_mps = 0.0;
    std::int64_t utc_ms = 0;  ///< When it was measured.
    double altitude_m = 0.0;
    double bearing_deg = 0.0;  ///< Clockwise from north.
  };
  std::vector<RadarRow> radar;
  std::vector<SpeedRow> speed;
  std::vector<GyroRow> gyro;
  std::vector<FixRow> fixes;
};

/// @return false with `error` naming file, line and fault. Rows out of order are a fault.
bool ReadComma2k19(const std::string& folder, Comma2k19Segment& segment, std::string& error);

struct Comma2k19Options {
  std::string radar_name = "FRONT";  ///< Channel RADAR_<NAME>.
  /// Added to long_dist_m. The collection's arrays count from 2.70 m behind the sensor.
  double range_offset_m = -2.7;
  bool flip_lateral = false;  ///< lat_left_m is right positive in this recording.
  /// From measurement to output of a fix. Best fit of this receiver's positions against the
  /// collection's post-processed pose.
  double gnss_latency_s = 0.06;
};

/// RADAR_<NAME> (one scan per radar cycle, sensor objects with their slot as track_id), EGO_MOTION
/// (at each speed sample; yaw rate = mean of the gyro since the one before) and EGO_GNSS, sorted by
/// `received`. Boot time becomes UTC by the median of utc_ms - t_boot, latency added.
/// @return empty with `error` set when a stream is empty.
std::vector<ImportedEvent> ToEvents(const Comma2k19Segment& segment,
                                    const Comma2k19Options& options, std::string& error);

}  // namespace v2vouch::sim
