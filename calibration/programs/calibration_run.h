// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/extrinsics/extrinsics.h"
#include "calibration/programs/drive_reader.h"
#include "daemon/rim/calibration_file/calibration_file.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/v2v/gps_bias/remote_solution.h"

namespace v2vouch {

/// One run of v2vouch-calibrate, before anything is written.
struct CalibrationRun {
  explicit CalibrationRun(ExtrinsicsResult&& found) : extrinsics(std::move(found)) {}

  std::vector<std::string> logs;
  ExtrinsicsResult extrinsics;
  std::vector<RemoteSolution> remotes;
  CalibrationFile file;
  std::int64_t events = 0;
  std::int64_t refused = 0;
  std::int64_t damaged = 0;
};

/// The vehicle as configured, without the calibration that the file may name: the prior is what was
/// measured on the car, not what was estimated last time.
bool LoadNominalConfig(const std::string& path, DaemonConfig& config,
                       std::vector<std::string>& problems);

/// Stage A on the car's own sensors, then stage B on what they confirm of others.
/// @return nullopt with `error` where a log cannot be read.
std::optional<CalibrationRun> Calibrate(const std::vector<std::string>& logs,
                                        const DaemonConfig& config, std::string& error,
                                        const std::function<void(double, const char*)>& progress);

/// One line of JSON, or a table for people.
std::string CalibrationJson(const CalibrationRun& run, double solve_s);
/// "3 of 22 parameters estimated, 2 weakly, 17 stay as configured".
std::string CalibrationVerdicts(const CalibrationRun& run);
std::string CalibrationText(const CalibrationRun& run, double solve_s);

/// Writes `folder`/index.html, one page with all pictures in it, making the folder.
bool WriteCalibrationReport(const CalibrationRun& run, const std::string& folder,
                            std::string& error);

}  // namespace v2vouch
