// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/data/vehicle.h"

namespace v2vouch {

/// What a calibration says of one of its parameters.
enum class CalibrationVerdict : std::int8_t {
  kEstimated,  ///< The drive told it.
  kWeak,       ///< The drive told it hardly better than was known before.
  kPrior,      ///< The drive told nothing of it.
  kAtBound,    ///< The estimate ran into the edge of what was allowed: no estimate.
  kRejected,   ///< The estimate did not pass its own tests.
};

/// "ESTIMATED", "WEAK", "PRIOR", "AT_BOUND", "REJECTED".
const char* VerdictName(CalibrationVerdict verdict);

/// Whether a value with this verdict takes the configured one's place: ESTIMATED and WEAK.
bool IsApplied(CalibrationVerdict verdict);

/// One parameter, all in the unit that its name ends with. Frames and signs are those of
/// vehicle.yaml (data/vehicle.h). `<sensor>` is the configured name in lower case:
///
///     radar_<sensor>.x_m, .y_m, .yaw_deg
///     camera_<sensor>.x_m, .y_m, .z_m, .yaw_deg, .pitch_deg, .roll_deg
///     ego.antenna_x_m, ego.antenna_y_m, ego.heading_bias_deg, ego.speed_scale,
///     ego.yaw_rate_bias_degps
///     ego.odometer_y_m  where across the car its speed is measured; told, applied to nothing
///     ego.slip_s2pm     rear-axle slip k: v_y = -k v^2 w; likewise
struct CalibratedParameter {
  std::string name;
  double value = 0.0;
  double std = 0.0;  ///< 1 sigma, above 0.
  double prior = 0.0;
  double prior_std = 0.0;
  CalibrationVerdict verdict = CalibrationVerdict::kPrior;
  std::string determined_by;  ///< In words, for people.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("name", name);
    a.Field("value", value);
    a.Field("std", std);
    a.Field("prior", prior);
    a.Field("prior_std", prior_std);
    a.Choice("verdict", verdict,
             {{"ESTIMATED", CalibrationVerdict::kEstimated},
              {"WEAK", CalibrationVerdict::kWeak},
              {"PRIOR", CalibrationVerdict::kPrior},
              {"AT_BOUND", CalibrationVerdict::kAtBound},
              {"REJECTED", CalibrationVerdict::kRejected}});
    a.Text("determined_by", determined_by);
  }
};

/// What `v2vouch-calibrate` found, as its file holds it.
struct CalibrationFile {
  int version = 1;         ///< Of the format.
  std::string vehicle_id;  ///< vehicle.id of the car it is for; "" = any.
  std::vector<std::string> log_sha256;
  std::string created;  ///< UTC time of the newest log's last event, ISO 8601; no wall clock.
  std::vector<CalibratedParameter> parameters;
  std::vector<std::string> correlated;  ///< Names of the rows of `covariance`.
  std::vector<double> covariance;       ///< Row-major, in the units of the names.
  /// SHA-256 of the file above its last line, hex. Set by LoadCalibration; saving makes its own.
  std::string checksum;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("version", version);
    a.Text("vehicle_id", vehicle_id);
    a.Field("log_sha256", log_sha256);
    a.Text("created", created);
    a.Field("parameters", parameters);
    a.Field("correlated", correlated);
    a.Field("covariance", covariance);
  }
};

/// A configured sensor's name as parameters spell it: in lower case.
std::string SensorKey(std::string name);

/// What is wrong with a calibration whatever car it is for: version, names, numbers that are no
/// numbers, standard deviations, a covariance that is none. `name` stands in front of problems.
void CheckCalibration(const CalibrationFile& calibration, const std::string& name,
                      std::vector<std::string>& problems);

/// Writes it for people and programs: YAML with the frames and signs on top and the checksum in the
/// last line. A power failure leaves the old file or the new one, whole. What CheckCalibration
/// refuses is not written.
bool SaveCalibration(const std::string& path, const CalibrationFile& calibration,
                     std::string& error);

/// @return nullopt with everything named that was wrong; a file that is not bit for bit what was
/// written (cut short, damaged, edited) is refused unread.
std::optional<CalibrationFile> LoadCalibration(const std::string& path,
                                               std::vector<std::string>& problems);
/// The same from a file's content. `name` stands in front of problems.
std::optional<CalibrationFile> ParseCalibration(std::string_view text, const std::string& name,
                                                std::vector<std::string>& problems);

/// Puts every ESTIMATED and WEAK value in the place of the configured one, by name. Refused as a
/// whole, `vehicle` untouched, where it is for another car, names a sensor that this one does not
/// have, or holds a value outside of what the configuration allows; for places and angles of
/// sensors and antenna also where it lies farther than 3 prior_std from the configured one, for
/// then it is another mount than the one that was measured.
bool ApplyCalibration(const CalibrationFile& calibration, VehicleConfig& vehicle,
                      std::vector<std::string>& problems);

}  // namespace v2vouch
