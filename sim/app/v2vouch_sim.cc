// SPDX-License-Identifier: Apache-2.0
// v2vouch-sim: a scenario -> sensor data, ego data, BSMs and truth, as a log or live over LCM.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/app/v2vouch_sim_run.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {
namespace {

constexpr int kUsage = 2;

constexpr const char* kExamples = R"(Examples:
  v2vouch-sim list
  v2vouch-sim run left_turn --seed 1 --out left_turn.lcm
  v2vouch-sim run left_turn --seed 1 --sensors ideal_points --out ideal.lcm
  v2vouch-sim run my_scenario.yaml --seed 7 --set radio.base_loss=0.5 --out lossy.lcm
  v2vouch-sim run urban --seed 1 --live -l 'udpm://239.255.76.67:7667?ttl=0'

The same scenario and seed give the same events, live or not. Scenarios are documented YAML; the
shipped left_turn.yaml explains every section.
Exit codes: 0 good, 1 the log or the LCM bus failed, 2 usage or scenario.)";

// Shipped scenarios: beside an installed program, else in the source tree it was built from.
std::filesystem::path ScenarioFolder() {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const auto installed = self.parent_path().parent_path() / "share/v2vouch/scenarios";
  if (std::filesystem::is_directory(installed, ignored)) return installed;
  return V2VOUCH_SCENARIO_DIR;
}

std::string FindScenario(const std::string& name) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name, ignored)) return name;
  const auto shipped = ScenarioFolder() / (name + ".yaml");
  return std::filesystem::is_regular_file(shipped, ignored) ? shipped.string() : name;
}

int List() {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(ScenarioFolder(), error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  if (error) {
    std::fprintf(stderr, "v2vouch-sim: %s: %s\n", ScenarioFolder().c_str(),
                 error.message().c_str());
    return kUsage;
  }
  std::sort(files.begin(), files.end());
  bool all_good = true;
  for (const auto& file : files) {
    Scenario scenario;
    std::vector<std::string> problems;
    all_good = LoadScenario(file.string(), scenario, problems) && all_good;
    for (const std::string& problem : problems) std::fprintf(stderr, "%s\n", problem.c_str());
    std::printf("%-12s %4.0f s  %s\n", file.stem().c_str(), scenario.duration_s,
                scenario.description.c_str());
  }
  return all_good ? 0 : kUsage;
}

}  // namespace
}  // namespace v2vouch::sim

int main(int argc, char** argv) {
  using namespace v2vouch::sim;
  CLI::App app("Simulates a drive: radar, camera, ego motion, GNSS, BSMs and truth of a scenario.",
               "v2vouch-sim");
  app.footer(kExamples);
  app.set_version_flag("--version", V2VOUCH_VERSION);
  app.require_subcommand(1);
  RunOptions options;
  std::string scenario;
  std::string sensors;
  auto* list = app.add_subcommand("list", "Shipped scenarios, one a line: name, length, content");
  auto* run = app.add_subcommand("run", "Simulates one scenario");
  run->footer(kExamples);
  run->add_option("SCENARIO", scenario, "Name of a shipped scenario, or a YAML file")->required();
  run->add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
  auto* out = run->add_option("--out", options.out, "Log file to write, at full speed");
  run->add_flag("--live", options.live, "Send over LCM in real time")->excludes(out);
  run->add_option("-l,--lcm-url", options.lcm_url, "LCM bus for --live [LCM_DEFAULT_URL]");
  run->add_option("--duration", options.duration_s, "Stop after this many seconds of the scenario")
      ->check(CLI::PositiveNumber);
  run->add_option("--sensors", sensors, "Instead of the scenario's own sensors.mode")
      ->check(CLI::IsMember({"realistic", "ideal_points"}));
  run->add_option("--set", options.settings, "KEY=VALUE, a scenario setting; may be repeated");
  run->add_flag("--json", options.json, "Report what was made as JSON on standard output");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  if (*list) return List();
  if (options.out.empty() && !options.live) {
    std::fprintf(stderr, "v2vouch-sim: one of --out LOG.lcm and --live is needed\n");
    return kUsage;
  }
  options.scenario = FindScenario(scenario);
  if (!sensors.empty()) options.settings.push_back("sensors.mode=" + sensors);
  return Run(options);
}
