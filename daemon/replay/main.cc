// SPDX-License-Identifier: Apache-2.0
// v2vouch-replay: a log through the same core as the daemon's.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <iostream>

#include "daemon/program/command_line.h"
#include "daemon/replay/replay.h"

namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouch-replay drive.lcm --out result.lcm
  v2vouch-replay drive.lcm --config vehicle.yaml --out result.lcm --json > figures.json

result.lcm holds all events of drive.lcm and the lists, reports and status of this run, each with the
time of the event that caused it. The same log and configuration give the same bytes.
No network runs: for a camera with source: image, what was recorded on CAMERA_<NAME>_DETECTED is the
input; v2vouch-detect --log puts that into a log of pictures.

Exit codes: 0 done; 1 the log could not be read or written, the run was stopped, or it made no list
(nothing on this vehicle's channels, nothing accepted, no ego motion); 2 usage or configuration.)";

volatile std::sig_atomic_t stop_requested = 0;

void RequestStop(int) { stop_requested = 1; }

bool ShowProgress(double share) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  if (is_terminal) std::fprintf(stderr, "\rreplaying %3.0f %%", 100.0 * share);
  return stop_requested == 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string in;
  std::string out;
  std::string config_path;
  std::string lcm_url;
  bool wants_json = false;
  CLI::App app(
      "Runs a recorded log through the perception core, as fast as it can, without sockets.");
  app.footer(kExamples);
  app.add_option("IN", in, "LCM log to read")->required();
  app.add_option("--out", out, "LCM log to write")->required();
  app.add_option("--config", config_path, "Vehicle description (default: the shipped vehicle)");
  app.add_flag("--json", wants_json, "Print the figures as JSON");
  app.add_option("-l,--lcm-url", lcm_url, "Taken like every program's; replay opens no socket");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-replay", argc, argv)) return *code;

  v2vouch::DaemonConfig config;
  std::vector<std::string> problems;
  std::vector<std::string> notes;
  if (!v2vouch::LoadDaemonConfig(config_path, config, problems, &notes)) {
    for (const std::string& problem : problems) std::cerr << problem << '\n';
    return 2;
  }

  for (const std::string& note : notes) std::cerr << "v2vouch-replay: note: " << note << '\n';

  std::signal(SIGINT, RequestStop);
  std::signal(SIGTERM, RequestStop);
  v2vouch::ReplayResult result;
  std::string error;
  const bool is_done = v2vouch::Replay(in, out, config, ShowProgress, result, error);
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  if (!is_done) {
    std::cerr << "v2vouch-replay: " << error << '\n';
    return 1;
  }
  std::cout << (wants_json ? v2vouch::JsonReport(result) : v2vouch::TextReport(result));
  for (const std::string& note : result.verdict.notes) {
    std::cerr << "v2vouch-replay: note: " << note << '\n';
  }
  for (const std::string& problem : result.verdict.problems) {
    std::cerr << "v2vouch-replay: " << in << ": " << problem << '\n';
  }
  return result.verdict.problems.empty() ? 0 : 1;
}
