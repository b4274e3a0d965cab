// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/data/calibration.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch {

/// "ESTIMATED", "WEAK", "PRIOR", "AT_BOUND", "REJECTED".
const char* VerdictName(CalibrationVerdict verdict);

/// Whether a value with this verdict takes the configured one's place: ESTIMATED and WEAK.
bool IsApplied(CalibrationVerdict verdict);

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

/// What is wrong with a calibration whatever car it is for: version, names, numbers that are no
/// numbers, standard deviations, a covariance that is none. `name` stands in front of problems.
void CheckCalibration(const CalibrationFile& calibration, const std::string& name,
                      std::vector<std::string>& problems);

/// Writes it for people and programs: YAML with the frames and signs on top and the checksum in the
/// last line. A power failure leaves the old file or the new one, whole. What CheckCalibration
/// refuses is not written.
bool SaveCalibration(const std::string& path, const CalibrationFile& calibration,
                     std::string& error, std::span<const std::string> inputs = {});

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
