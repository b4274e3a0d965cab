// SPDX-License-Identifier: Apache-2.0
#include "calibration/programs/calibration_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "calibration/programs/remote_pairs.h"
#include "daemon/rim/config/yaml_reader.h"

namespace v2vouch {
namespace {

std::string Iso8601(Timestamp stamp) {
  const std::chrono::sys_seconds seconds{std::chrono::seconds(ToMicros(stamp) / 1'000'000)};
  const auto day = std::chrono::floor<std::chrono::days>(seconds);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(seconds - day);
  char text[80];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()));
  return text;
}

CalibrationFile FileOf(const Drive& drive, const ExtrinsicsResult& result,
                       const std::string& vehicle_id) {
  CalibrationFile file;
  file.vehicle_id = vehicle_id;
  file.log_sha256 = drive.log_sha256;
  file.created = Iso8601(drive.newest);
  // PRIOR parameters have no part in the covariance: nothing was learnt that could correlate.
  std::vector<int> rows;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    file.parameters.push_back(result.parameters[i]);
    if (IsApplied(result.parameters[i].verdict)) rows.push_back(static_cast<int>(i));
  }
  const auto& descriptions = result.mounting.descriptions();
  for (const int row : rows) {
    const auto& of_row = descriptions[static_cast<std::size_t>(row)];
    file.correlated.push_back(of_row.name);
    for (const int column : rows) {
      const double scale = of_row.to_unit * descriptions[static_cast<std::size_t>(column)].to_unit;
      file.covariance.push_back(scale * 0.5 *
                                (result.covariance(row, column) + result.covariance(column, row)));
    }
  }
  return file;
}

// What stage A's doubt adds to every place that a sender was seen at: the lever arm alike, heading
// and mounting angles with range.
void ConsiderOf(const ExtrinsicsResult& result, double& m, double& rad) {
  double places = 0.0;
  double angles = 0.0;
  for (const MountingEstimate& p : result.parameters) {
    if (!IsApplied(p.verdict)) continue;
    const double std = p.name.ends_with("_deg") ? FromDegrees(p.std) : p.std;
    if (p.name.starts_with("ego.antenna")) places += std * std;
    if (p.name == "ego.heading_bias_deg") angles += std * std;
    if (p.name.starts_with("radar_") && p.name.ends_with("yaw_deg")) {
      angles = std::max(angles, 2.0 * std * std);
    }
  }
  m = std::sqrt(places);
  rad = std::sqrt(angles);
}

}  // namespace

bool LoadNominalConfig(const std::string& path, DaemonConfig& config,
                       std::vector<std::string>& problems) {
  if (!path.empty()) config::Load(path, config, problems);
  CheckConfig(config, path.empty() ? "built-in configuration" : path, problems);
  config.calibration.clear();
  return problems.empty();
}

std::optional<CalibrationRun> Calibrate(const std::vector<std::string>& logs,
                                        const DaemonConfig& config, std::string& error,
                                        const std::function<void(double, const char*)>& progress) {
  const auto part = [&](double from, double to, const char* what) {
    return [&progress, from, to, what](double share) {
      if (progress) progress(from + (to - from) * share, what);
    };
  };
  // The instruments as they speak: what the configuration knows of them is the prior.
  DaemonConfig raw = config;
  raw.perception.vehicle.speed_scale = 1.0;
  raw.perception.vehicle.yaw_rate_bias_radps = 0.0;
  raw.perception.vehicle.heading_bias_rad = 0.0;
  Drive drive;
  if (!ReadDrive(logs, raw, drive, error, part(0.0, 0.05, "reading"))) return std::nullopt;
  CalibrationRun run(
      CalibrateExtrinsics(drive.own, config.perception.vehicle,
                          {.priors = {}, .point_targets = config.perception.tracking.point_targets},
                          [&](double share, const char* what) {
                            if (progress) progress(0.05 + 0.6 * share, what);
                          }));
  run.logs = logs;
  run.events = drive.events;
  run.refused = drive.refused;
  run.damaged = drive.damaged;
  run.file = FileOf(drive, run.extrinsics, config.perception.vehicle.id);

  DaemonConfig calibrated = config;
  std::vector<std::string> problems;
  if (run.extrinsics.accepted &&
      ApplyCalibration(run.file, calibrated.perception.vehicle, problems)) {
    std::vector<RemotePair> pairs;
    if (!CollectRemotePairs(logs, calibrated, pairs, error, part(0.65, 1.0, "other vehicles"))) {
      return std::nullopt;
    }
    double consider_m = 0.0;
    double consider_rad = 0.0;
    ConsiderOf(run.extrinsics, consider_m, consider_rad);
    run.remotes = SolveRemotes(pairs, consider_m, consider_rad, {});
  }
  for (const std::string& problem : problems) run.extrinsics.problems.push_back(problem);
  run.extrinsics.accepted = run.extrinsics.problems.empty();
  return run;
}

}  // namespace v2vouch
