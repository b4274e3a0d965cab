// SPDX-License-Identifier: Apache-2.0
// v2vouch-calibrate: where the sensors really sit, from recorded drives.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "calibration/programs/calibration_run.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/output_file.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"

namespace v2vouch {
namespace {

constexpr const char* kExamples = R"(Examples:
  v2vouch-calibrate drive.lcm --config vehicle.yaml --out calibration.yaml
  v2vouch-calibrate monday.lcm tuesday.lcm --config vehicle.yaml --out calibration.yaml --report report
  v2vouch-sim run calibration_drive --seed 1 --out drive.lcm
  v2vouch-calibrate drive.lcm --config daemon/vehicles/vehicle_points.yaml --out calibration.yaml --json

Then name the file in vehicle.yaml: `calibration: calibration.yaml`. A drive of ten minutes with turns
both ways, different speeds, standing things beside the road and some traffic tells everything; where
something is missing, the table says what.

Exit codes: 0 calibrated (what stays as configured is told with its reason); 1 not accepted or a log
cannot be read, nothing replaced; 2 usage or configuration.)";

void ShowProgress(double share, const char* what) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  if (!is_terminal) return;
  const int done = static_cast<int>(30.0 * share);
  std::fprintf(stderr, "\r\033[K[%-30s] %3.0f %%  %s", std::string(done, '=').c_str(),
               100.0 * share, what);
}

// What no drive tells: see the table's hint.
bool IsHeldByTheCar(const std::string& name) {
  return name.ends_with(".odometer_y_m") || name.ends_with(".slip_s2pm");
}

void Complain(const std::string& what) {
  std::fprintf(stderr, "v2vouch-calibrate: %s\n", what.c_str());
}

// Writes the report and, where the result is accepted, the calibration file.
int Deliver(const CalibrationRun& run, const std::string& out, const std::string& report,
            const std::vector<std::string>& inputs) {
  std::string error;
  if (!report.empty() && !WriteCalibrationReport(run, report, error)) {
    Complain(error);
    return kExitFailed;
  }
  if (!run.extrinsics.accepted) {
    for (const std::string& problem : run.extrinsics.problems) Complain(problem);
    Complain("not accepted; " + out + " is as it was");
    return kExitFailed;
  }
  if (!SaveCalibration(out, run.file, error, inputs)) {
    Complain(error);
    return kExitFailed;
  }
  const bool is_whole = std::ranges::none_of(run.extrinsics.parameters, [](const auto& p) {
    return !IsApplied(p.verdict) && !IsHeldByTheCar(p.name);
  });
  if (!is_whole) {
    Complain("note: " + CalibrationVerdicts(run) + "; the table says why and what helps");
  }
  return kExitGood;
}

int Run(int argc, char** argv) {
  CLI::App app{
      "Calibrates sensor mounting, antenna, heading bias and speed scale from recorded drives.",
      "v2vouch-calibrate"};
  app.footer(kExamples);
  std::vector<std::string> logs;
  std::string config_path;
  std::string out;
  std::string report;
  std::string lcm_url;
  bool as_json = false;
  app.add_option("LOG", logs, "LCM logs of drives with this car")->required();
  app.add_option("--config", config_path, "vehicle description (default: the shipped vehicle)");
  app.add_option("--out", out, "calibration file to write, or to replace as a whole")->required();
  app.add_option("--report", report, "folder for a page of residuals, index.html");
  app.add_flag("--json", as_json, "figures as one line of JSON");
  app.add_option("-l,--lcm-url", lcm_url, "taken like every program's; no socket is opened")
      ->check(CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-calibrate", argc, argv))
    return *code;
  DaemonConfig config;
  std::vector<std::string> problems;
  if (!LoadNominalConfig(config_path, config, problems)) {
    for (const std::string& problem : problems) Complain(problem);
    return kExitUsage;
  }
  std::string error;
  std::vector<std::string> inputs = logs;
  inputs.push_back(config_path);
  if (LookAtOutput(out, inputs, error) == OutputPlace::kRefused) {  // Before minutes of work.
    Complain(error);
    return kExitFailed;
  }
  const auto start = std::chrono::steady_clock::now();
  const auto run = Calibrate(logs, config, error, ShowProgress);
  const double solve_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  if (!run) {
    Complain(error);
    return kExitFailed;
  }
  std::fputs((as_json ? CalibrationJson(*run, solve_s) : CalibrationText(*run, solve_s)).c_str(),
             stdout);
  return Deliver(*run, out, report, inputs);
}

}  // namespace
}  // namespace v2vouch

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-calibrate");
  return v2vouch::Run(argc, argv);
}
