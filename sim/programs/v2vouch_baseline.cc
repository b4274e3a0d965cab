// SPDX-License-Identifier: Apache-2.0
// v2vouch-baseline: a log through the plain tracker of sim/baseline, to compare LOCAL with.
#include <cstdio>
#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "daemon/common/data/vehicle_section.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/baseline/baseline_log.h"

namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  v2vouch-baseline drive.lcm --config vehicle.yaml --out base.lcm\n"
    "  v2vouch-eval base.lcm --scorecard\n"
    "\nExit codes: 0 good; 1 a log cannot be read or written; 2 usage or configuration.";

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-baseline");
  CLI::App app("Runs a log through a plain tracker: the floor that LOCAL must beat.");
  app.footer(kExamples);
  std::string in, config, out;
  app.add_option("IN", in, "LCM log to read")->required();
  app.add_option("--out", out, "LCM log to write: TRUTH and TRACKS_LOCAL")->required();
  app.add_option("--config", config, "Vehicle description (default: the shipped vehicle)");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-baseline", argc, argv)) return *code;
  v2vouch::VehicleSection file;
  std::vector<std::string> problems;
  if (!config.empty() && !v2vouch::config::Load(config, file, problems)) {
    for (const std::string& problem : problems) {
      std::fprintf(stderr, "v2vouch-baseline: %s\n", problem.c_str());
    }
    return v2vouch::kExitUsage;
  }
  std::string error;
  const auto damaged =
      v2vouch::baseline::RunBaseline(in, file.vehicle, v2vouch::config::Print(file), out, error);
  if (!damaged) {
    std::fprintf(stderr, "v2vouch-baseline: %s\n", error.c_str());
    return v2vouch::kExitFailed;
  }
  v2vouch::NoteDamage("v2vouch-baseline", in, *damaged);
  return 0;
}
