// SPDX-License-Identifier: Apache-2.0
// v2vouch-sim: a scenario -> sensor data, ego data, BSMs and truth, as a log or live over LCM.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/programs/shipped_files.h"
#include "sim/programs/v2vouch_sim_run.h"
#include "sim/world/draw_sensors.h"
#include "sim/world/overlay.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {
namespace {

constexpr const char* kExamples = R"(Examples:
  v2vouch-sim list
  v2vouch-sim run left_turn --seed 1 --out left_turn.lcm
  v2vouch-sim run left_turn --seed 1 --sensors ideal_points --out ideal.lcm
  v2vouch-sim run urban --seed 3 --sensors random --out drive.lcm --vehicle-out drive.yaml
  v2vouch-sim run my_scenario.yaml --seed 7 --set radio.base_loss=0.5 --out lossy.lcm
  v2vouch-sim run campaign_urban --seed 1 --with my_attack.yaml --set traffic.vehicles=20 --out a.lcm
  v2vouch-sim run urban --seed 1 --live -l 'udpm://239.255.76.67:7667?ttl=0'

The same scenario and seed give the same events, live or not. Scenarios are documented YAML; the
shipped left_turn.yaml explains every section.
Exit codes: 0 good, 1 the log or the LCM bus failed, 2 usage or scenario.)";

std::vector<std::string> SensorModes() {
  std::vector<std::string> modes = {"realistic", "ideal_points"};
  for (std::string& family : DrawnFamilies()) modes.push_back(std::move(family));
  return modes;
}

int List(bool as_json) {
  std::vector<std::string> problems;
  nlohmann::ordered_json scenarios = nlohmann::ordered_json::array();
  nlohmann::ordered_json catalogue = nlohmann::ordered_json::array();
  std::string folder_problem;
  for (const auto& file : ShippedScenarios(folder_problem)) {
    Scenario scenario;
    LoadScenario(file.string(), scenario, problems);
    scenarios.push_back({{"name", file.stem().string()},
                         {"seconds", scenario.duration_s},
                         {"description", scenario.description}});
  }
  for (const auto& file : ShippedOverlays(folder_problem)) {
    Overlay overlay;
    LoadOverlay(file.string(), overlay, problems);
    catalogue.push_back({{"name", overlay.name},
                         {"file", file.filename().string()},
                         {"suits", overlay.suits},
                         {"description", overlay.description}});
  }
  if (!folder_problem.empty()) problems.push_back(folder_problem);
  for (const std::string& problem : problems) {
    std::fprintf(stderr, "v2vouch-sim: %s\n", problem.c_str());
  }
  if (as_json) {
    const nlohmann::ordered_json all = {{"scenarios", scenarios}, {"catalogue", catalogue}};
    std::printf("%s\n", all.dump().c_str());
    return problems.empty() ? 0 : kExitUsage;
  }
  const auto text = [](const nlohmann::ordered_json& entry, const char* key) {
    return entry[key].get<std::string>();
  };
  for (const auto& entry : scenarios) {
    std::printf("%-20s %4.0f s  %s\n", text(entry, "name").c_str(), entry["seconds"].get<double>(),
                text(entry, "description").c_str());
  }
  if (!catalogue.empty()) std::printf("\nTo lay over a scenario, --with NAME:\n");
  for (const auto& entry : catalogue) {
    std::printf("%-26s  %s\n", text(entry, "name").c_str(), text(entry, "description").c_str());
  }
  return problems.empty() ? 0 : kExitUsage;
}

}  // namespace
}  // namespace v2vouch::sim

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-sim");
  using namespace v2vouch::sim;
  CLI::App app("Simulates a drive: radar, camera, ego motion, GNSS, BSMs and truth of a scenario.",
               "v2vouch-sim");
  app.footer(kExamples);
  app.require_subcommand(1);
  RunOptions options;
  std::string scenario;
  std::string sensors;
  std::vector<std::string> overlays;
  auto* list =
      app.add_subcommand("list", "Shipped scenarios and overlays, one a line: name, content");
  bool as_json = false;
  list->add_flag("--json", as_json, "The same as JSON");
  auto* run = app.add_subcommand("run", "Simulates one scenario");
  run->footer(kExamples);
  run->add_option("SCENARIO", scenario, "Name of a shipped scenario, or a YAML file")->required();
  run->add_option("--seed", options.seed, "Seed of all random numbers")->capture_default_str();
  auto* out = run->add_option("--out", options.out, "Log file to write, at full speed");
  run->add_flag("--live", options.live, "Send over LCM in real time")->excludes(out);
  run->add_option("-l,--lcm-url", options.lcm_url, "LCM bus for --live [LCM_DEFAULT_URL]")
      ->check(v2vouch::CheckLcmUrl);
  run->add_option("--duration", options.duration_s, "Stop after this many seconds of the scenario")
      ->check(v2vouch::AboveZero());
  run->add_option("--sensors", sensors, "Instead of the scenario's own sensors.mode")
      ->check(v2vouch::OneOf(SensorModes()));
  run->add_option("--vehicle-out", options.vehicle_out,
                  "Write the ego's configuration for the daemon, what is drawn included");
  run->add_option("--set", options.settings, "KEY=VALUE, a scenario setting; may be repeated");
  run->add_option(
      "--with", overlays,
      "Overlay, a YAML file or the name of a shipped one (attack, condition); may be repeated");
  run->add_flag("--json", options.json, "Report what was made as JSON on standard output");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-sim", argc, argv)) return *code;
  if (*list) return List(as_json);
  if (options.out.empty() && !options.live) {
    std::fprintf(stderr, "v2vouch-sim: one of --out LOG.lcm and --live is needed\n");
    return v2vouch::kExitUsage;
  }
  const std::string url_problem =
      options.live ? v2vouch::CheckLcmUrl(v2vouch::EffectiveLcmUrl(options.lcm_url)) : "";
  if (!url_problem.empty()) {
    std::fprintf(stderr, "v2vouch-sim: %s\n", url_problem.c_str());
    return v2vouch::kExitUsage;
  }
  std::string problem;
  options.scenario = FindScenario(scenario, problem);
  for (const std::string& overlay : overlays) {
    options.overlays.push_back(FindOverlay(overlay, problem));
  }
  if (!problem.empty()) {
    std::fprintf(stderr, "v2vouch-sim: %s", problem.c_str());
    return v2vouch::kExitUsage;
  }
  if (!sensors.empty()) options.settings.push_back("sensors.mode=" + sensors);
  return Run(options);
}
