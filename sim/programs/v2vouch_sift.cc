// SPDX-License-Identifier: Apache-2.0
// v2vouch-sift: a log with a difficulty taken away by truth: one rung of the ladder (sim/ladder).
#include <cstdio>
#include <string>
#include <vector>

#include "daemon/common/data/vehicle.h"
#include "daemon/common/data/vehicle_section.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/ladder/sift.h"

namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  v2vouch-sift drive.lcm --config vehicle.yaml --rung existence --out sifted.lcm\n"
    "  v2vouch-sift drive.lcm --config vehicle.yaml --rung association --out alone.lcm   "
    "(alone.7.lcm, ...)\n"
    "\nPrints the files written. Exit codes: 0 good; 1 a log cannot be read or written; 2 usage "
    "or\n"
    "configuration. scripts/measure_ladder runs all rungs.";

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-sift");
  using v2vouch::ladder::Rung;
  CLI::App app(
      "Takes a difficulty out of a log by its truth: false detections, association, extent.");
  app.footer(kExamples);
  std::string in, config, out, rung;
  app.add_option("IN", in, "LCM log with TRUTH")->required();
  app.add_option("--out", out, "LCM log to write")->required();
  app.add_option("--config", config, "Vehicle description (default: the shipped vehicle)");
  app.add_option("--rung", rung, "What stays: of road users only; of one each; as points")
      ->required()
      ->check(v2vouch::OneOf({"existence", "association", "extent"}));
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-sift", argc, argv)) return *code;
  v2vouch::VehicleSection file;
  std::vector<std::string> problems;
  if (!config.empty() && !v2vouch::config::Load(config, file, problems)) {
    for (const std::string& problem : problems) {
      std::fprintf(stderr, "v2vouch-sift: %s\n", problem.c_str());
    }
    return v2vouch::kExitUsage;
  }
  const Rung which = rung == "existence"     ? Rung::kExistence
                     : rung == "association" ? Rung::kAssociation
                                             : Rung::kExtent;
  std::vector<std::string> written;
  std::string error;
  const auto damaged = v2vouch::ladder::Sift(in, file.vehicle, which, out, written, error);
  for (const std::string& path : written) std::printf("%s\n", path.c_str());
  if (!damaged) {
    std::fprintf(stderr, "v2vouch-sift: %s\n", error.c_str());
    return v2vouch::kExitFailed;
  }
  v2vouch::NoteDamage("v2vouch-sift", in, *damaged);
  return v2vouch::kExitGood;
}
