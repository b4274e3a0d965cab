// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/v2vouch_sim_run.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "daemon/common/data/vehicle_section.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"
#include "sim/simulation/simulation.h"
#include "sim/world/overlay.h"
#include "sim/world/world.h"

namespace v2vouch::sim {
namespace {

void Complain(const std::string& what) { std::fprintf(stderr, "v2vouch-sim: %s\n", what.c_str()); }

// "a.b=c" as YAML: a section holding a section holding c.
std::string AsYaml(const std::string& setting) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) return "";
  std::string yaml;
  std::size_t depth = 0;
  for (std::size_t from = 0; from <= equals;) {
    const std::size_t to = std::min(setting.find('.', from), equals);
    yaml += std::string(2 * depth++, ' ') + setting.substr(from, to - from) + ":";
    yaml += to == equals ? " " : "\n";
    from = to + 1;
  }
  return yaml + setting.substr(equals + 1) + "\n";
}

bool Apply(const RunOptions& options, Scenario& scenario, std::vector<std::string>& problems) {
  for (const std::string& overlay : options.overlays) LayOver(overlay, scenario, problems);
  for (const std::string& setting : options.settings) {
    const std::string yaml = AsYaml(setting);
    if (yaml.empty()) {
      problems.push_back("--set " + setting + ": must be KEY=VALUE");
    } else {
      config::Parse(yaml, "--set " + setting, scenario, problems);
    }
  }
  if (options.duration_s > 0.0) {
    scenario.duration_s = std::min(scenario.duration_s, options.duration_s);
  }
  return problems.empty() && CheckReferences(scenario, problems);
}

// Where events go.
class Sink {
 public:
  virtual ~Sink() = default;
  /// @return false when it cannot be delivered.
  virtual bool Take(const SimEvent& event) = 0;
  virtual bool Finish(std::string& error) = 0;
};

class LogSink : public Sink {
 public:
  explicit LogSink(std::unique_ptr<LogWriter> writer) : writer_(std::move(writer)) {}
  bool Take(const SimEvent& event) override {
    writer_->Write(event.arrival, event.channel, event.bytes);
    return writer_->is_good();
  }
  bool Finish(std::string& error) override { return writer_->Close(error); }

 private:
  std::unique_ptr<LogWriter> writer_;
};

// Sends every event when the wall clock has come as far as the scenario's.
class LiveSink : public Sink {
 public:
  explicit LiveSink(const std::string& url) : lcm_(url) {}
  [[nodiscard]] bool good() const { return lcm_.good(); }

  bool Take(const SimEvent& event) override {
    if (!started_) {
      started_ = true;
      first_ = event.arrival;
      begin_ = std::chrono::steady_clock::now();
    }
    const auto due = begin_ + (event.arrival - first_);
    while (!IsStopAsked()) {  // In short naps, so that Ctrl-C is heard at once.
      const auto left = due - std::chrono::steady_clock::now();
      if (left <= std::chrono::steady_clock::duration::zero()) break;
      std::this_thread::sleep_for(
          std::min<std::chrono::steady_clock::duration>(left, std::chrono::milliseconds(100)));
    }
    return lcm_.publish(event.channel, event.bytes.data(),
                        static_cast<unsigned>(event.bytes.size())) == 0;
  }
  bool Finish(std::string&) override { return true; }

 private:
  lcm::LCM lcm_;
  bool started_ = false;
  Timestamp first_{};
  std::chrono::steady_clock::time_point begin_{};
};

std::unique_ptr<Sink> OpenSink(const RunOptions& options, std::string& error) {
  if (!options.live) {
    std::vector<std::string> inputs = options.overlays;
    inputs.push_back(options.scenario);
    auto writer = LogWriter::Create(options.out, error, inputs);
    return writer ? std::make_unique<LogSink>(std::move(writer)) : nullptr;
  }
  auto live = std::make_unique<LiveSink>(options.lcm_url);
  if (live->good()) return live;
  error = "LCM bus '" + options.lcm_url + "' cannot be opened (is there a multicast route?)";
  return nullptr;
}

bool WriteVehicle(const Scenario& scenario, const std::string& path, std::string& error) {
  std::ofstream file(path);
  file << config::Print(VehicleSection{scenario.vehicle});
  file.close();
  if (!file) error = path + ": cannot be written";
  return static_cast<bool>(file);
}

}  // namespace

struct Figures {
  std::map<std::string, std::int64_t> counts;  // By channel.
  std::int64_t unsent = 0;
  double simulated_s = 0.0;
  double wall_s = 0.0;
};

void PrintFigures(const std::string& scenario, const RunOptions& options, const Figures& figures) {
  const auto& [counts, unsent, simulated, wall] = figures;
  if (options.json) {
    const nlohmann::ordered_json report = {{"scenario", scenario}, {"seed", options.seed},
                                           {"seconds", simulated}, {"wall_seconds", wall},
                                           {"events", counts},     {"unsent", unsent}};
    std::printf("%s\n", report.dump().c_str());
  } else {
    std::printf("%s, seed %llu: %.1f s in %.2f s\n", scenario.c_str(),
                static_cast<unsigned long long>(options.seed), simulated, wall);
    for (const auto& [channel, count] : counts) {
      std::printf("  %-24s %8lld\n", channel.c_str(), static_cast<long long>(count));
    }
  }
}
int Run(const RunOptions& options) {
  Scenario scenario;
  std::vector<std::string> problems;
  std::unique_ptr<World> world;
  if (LoadScenario(options.scenario, scenario, problems) && Apply(options, scenario, problems)) {
    world = World::Make(scenario, options.seed, problems);
  }
  if (!world) {
    for (const std::string& problem : problems) Complain(problem);
    return kExitUsage;
  }
  std::string error;
  if (!options.vehicle_out.empty() &&
      !WriteVehicle(world->scenario(), options.vehicle_out, error)) {
    Complain(error);
    return kExitFailed;
  }
  const auto sink = OpenSink(options, error);
  if (!sink) {
    Complain(error);
    return kExitFailed;
  }
  HandleStopSignals();

  const auto begin = std::chrono::steady_clock::now();
  const bool shows_progress = isatty(STDERR_FILENO) != 0;
  std::map<std::string, std::int64_t> counts;
  std::int64_t unsent = 0;
  Simulation simulation(*world, options.seed);
  for (const std::string& note : simulation.notes()) Complain(note);
  std::vector<SimEvent> events;
  for (bool more = true; more && !IsStopAsked();) {
    more = simulation.Step(events);
    for (const SimEvent& event : events) {
      if (IsStopAsked()) break;
      if (!sink->Take(event)) ++unsent;
      ++counts[event.channel];
    }
    if (!options.live && unsent > 0) break;  // The disk is full: Finish() says so.
    if (shows_progress) {
      std::fprintf(stderr, "\r%s: %3.0f %% of %.0f s ", scenario.name.c_str(),
                   100.0 * simulation.progress(), scenario.duration_s);
    }
  }
  if (shows_progress) std::fprintf(stderr, "\n");
  const bool finished = sink->Finish(error);
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  PrintFigures(scenario.name, options,
               {counts, unsent, simulation.progress() * scenario.duration_s, wall});
  if (!finished) Complain(error);
  if (options.live && unsent > 0) Complain(std::to_string(unsent) + " messages could not be sent");
  return finished && unsent == 0 ? 0 : kExitFailed;
}

}  // namespace v2vouch::sim
