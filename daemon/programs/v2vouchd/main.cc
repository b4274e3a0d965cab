// SPDX-License-Identifier: Apache-2.0
// v2vouchd: the perception daemon.
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <iostream>
#include <memory>

#include "daemon/detector/network_detector.h"
#include "daemon/programs/v2vouchd/daemon.h"
#include "daemon/programs/v2vouchd/stderr_relay.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouchd --config vehicle.yaml
  v2vouchd -l 'udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304' \
           --v2v-lcm-url 'udpm://239.255.76.68:7668?ttl=0'
  v2vouchd --config vehicle.yaml --print-config

Publishes TRACKS_LOCAL, TRACKS_PRIORITY, TRACKS_V2V, MISBEHAVIOR, CALIBRATION, V2VOUCH_CONFIG and,
once a second, V2VOUCH_STATUS. Ends on Ctrl-C or SIGTERM; SIGHUP only says in the log that settings need a restart.
Under systemd (Type=notify) it tells when it runs, and feeds the watchdog while all its parts go on.

Exit codes: 0 ended on request; 1 something failed while running; 2 usage or configuration.)";

// The camera network, where a camera sends pictures: without it pictures are of no use.
std::unique_ptr<v2vouch::ObjectDetector> LoadDetector(const v2vouch::DaemonConfig& config,
                                                      std::vector<std::string>& problems) {
  for (const v2vouch::CameraConfig& camera : config.perception.vehicle.cameras) {
    if (camera.source != v2vouch::CameraSource::kImage) continue;
    if (!config.detector.model.empty()) {
      return v2vouch::NetworkDetector::Load(config.detector, problems);
    }
    problems.push_back("camera " + camera.name +
                       " has source: image, but detector.model names no network; a smart camera's "
                       "boxes need none (source: boxes)");
    return nullptr;
  }
  return nullptr;
}

void PrintSummary(const v2vouch::DaemonSummary& summary) {
  spdlog::info(
      "event=stopped accepted={} lists={} stale_lists={} withheld_lists={} queue_drops_own={} "
      "queue_drops_bsm={} digest_local={} digest_priority={}",
      summary.accepted, summary.lists, summary.stale_lists, summary.withheld_lists,
      summary.queue_drops_own, summary.queue_drops_bsm, summary.digest_local,
      summary.digest_priority);
  for (std::size_t i = 0; i < v2vouch::kReasonCount; ++i) {
    if (summary.refused[i] == 0) continue;
    spdlog::info("event=refused_in_all reason={} total={}",
                 v2vouch::ReasonName(static_cast<v2vouch::Reason>(i)), summary.refused[i]);
  }
  for (const v2vouch::wire::DroppedDatagrams& dropped : summary.dropped) {
    spdlog::info("event=refused_in_all channel={} reason={} field=\"{}\" total={}", dropped.bus,
                 dropped.reason, dropped.field, dropped.count);
  }
}

struct Options {
  std::string config_path;
  std::string url;
  std::string v2v_url;
  std::string state_file;
  bool prints_config = false;
  bool prints_keys = false;
  bool keeps_no_state = false;
};

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("--config", options.config_path,
                 "Vehicle description (default: the shipped vehicle)");
  app.add_option("-l,--lcm-url", options.url,
                 "LCM URL (default: lcm.url of the configuration, else "
                 "LCM_DEFAULT_URL)");
  app.add_option("--v2v-lcm-url", options.v2v_url, "LCM URL of BSMs, on a port of its own");
  app.add_option("--state", options.state_file,
                 "File that keeps senders' penalties over a restart (default: state.file of the "
                 "configuration, else trust.state in STATE_DIRECTORY, else none)");
  app.add_flag("--no-state", options.keeps_no_state, "Neither read nor write such a file");
  app.add_flag("--print-config", options.prints_config,
               "Print the effective configuration and end");
  app.add_flag("--print-config-keys", options.prints_keys,
               "Print every key with its range and built-in value, one a line, and end");
}

// What the command line and the service manager say goes before the configuration file.
void Override(const Options& options, v2vouch::DaemonConfig& config,
              std::vector<std::string>& problems) {
  if (!options.url.empty()) config.lcm.url = options.url;
  if (!options.v2v_url.empty()) config.lcm.v2v_url = options.v2v_url;
  if (!options.state_file.empty()) config.state.file = options.state_file;
  if (const char* folder = std::getenv("STATE_DIRECTORY"); folder && config.state.file.empty()) {
    const std::string folders = folder;  // systemd may name several, with a colon between.
    config.state.file = folders.substr(0, folders.find(':')) + "/trust.state";
  }
  if (options.keeps_no_state) config.state.enabled = false;
  for (const std::string& given : {v2vouch::EffectiveLcmUrl(config.lcm.url), config.lcm.v2v_url}) {
    const auto faults = v2vouch::LcmUrlProblems(given);
    problems.insert(problems.end(), faults.begin(), faults.end());
  }
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouchd");
  Options options;
  CLI::App app("Tells the car which vehicles are around it, and which it may rely on.");
  app.footer(kExamples);
  AddOptions(app, options);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouchd", argc, argv)) return *code;
  if (options.prints_keys) {
    for (const auto& key : v2vouch::DaemonConfigKeys()) {
      std::printf("%s\t%s\t%s\n", key.path.c_str(), key.range.c_str(), key.value.c_str());
    }
    return 0;
  }

  v2vouch::DaemonConfig config;
  std::vector<std::string> problems;
  std::vector<std::string> notes;
  v2vouch::LoadDaemonConfig(options.config_path, config, problems, &notes);
  Override(options, config, problems);
  std::unique_ptr<v2vouch::ObjectDetector> detector;
  if (problems.empty() && !options.prints_config) detector = LoadDetector(config, problems);
  for (const std::string& problem : problems) std::cerr << problem << '\n';
  if (!problems.empty()) return 2;
  for (const std::string& note : notes) std::cerr << "note: " << note << '\n';
  if (options.prints_config) {
    v2vouch::MakeAbsolute(options.config_path, config);
    std::cout << v2vouch::PrintDaemonConfig(config);
    return 0;
  }

  const v2vouch::StderrRelay relay;  // From here on perception runs: no line of log holds it up.
  spdlog::set_default_logger(spdlog::stderr_logger_mt("v2vouchd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e level=%l %v");
  if (detector) {
    spdlog::info("event=network model=\"{}\" input={}x{} threads={}", config.detector.model,
                 config.detector.input_width_px, config.detector.input_height_px,
                 config.detector.threads);
  } else {
    spdlog::info("event=no_network hint=\"boxes come from smart cameras\"");
  }
  v2vouch::HandleStopSignals();
  v2vouch::HandleReloadSignal();
  try {
    PrintSummary(v2vouch::RunDaemon(config, detector.get(), v2vouch::IsStopAsked));
  } catch (const std::exception& error) {
    spdlog::critical("event=failed what=\"{}\"", error.what());
    return 1;
  }
  return 0;
}
