// SPDX-License-Identifier: Apache-2.0
// v2vouch-replay: a log through the same core as the daemon's.
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "daemon/programs/replay/replay.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

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

bool ShowProgress(double share) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  static int shown = -1;
  const int percent = static_cast<int>(100.0 * share);
  if (is_terminal && percent != shown) {
    std::fprintf(stderr, "\rreplaying %3d %%", percent);
    shown = percent;
  }
  return !v2vouch::IsStopAsked();
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-replay");
  std::string in;
  std::string out;
  std::string config_path;
  std::string lcm_url;
  std::string state_file;
  bool wants_json = false;
  CLI::App app(
      "Runs a recorded log through the perception core, as fast as it can, without sockets.");
  app.footer(kExamples);
  app.add_option("IN", in, "LCM log to read")->required();
  app.add_option("--out", out, "LCM log to write")->required();
  app.add_option("--config", config_path, "Vehicle description (default: the shipped vehicle)");
  app.add_option("--state", state_file,
                 "Senders' penalties that a daemon kept; a copy of its file, not written")
      ->check(CLI::ExistingFile);
  app.add_flag("--json", wants_json, "Print the figures as JSON");
  app.add_option("-l,--lcm-url", lcm_url, "Taken like every program's; replay opens no socket")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-replay", argc, argv)) return *code;

  v2vouch::DaemonConfig config;
  std::vector<std::string> problems;
  std::vector<std::string> notes;
  const bool is_loaded = v2vouch::LoadDaemonConfig(config_path, config, problems, &notes);
  config.state.file = state_file;  // That of the configuration is the daemon's.
  if (!is_loaded) {
    for (const std::string& problem : problems) std::cerr << problem << '\n';
    return 2;
  }

  for (const std::string& note : notes) std::cerr << "v2vouch-replay: note: " << note << '\n';

  v2vouch::HandleStopSignals();
  v2vouch::ReplayResult result;
  std::string error;
  const bool is_done = v2vouch::Replay(in, out, config, ShowProgress, result, error);
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  if (!is_done) {
    std::cerr << "v2vouch-replay: " << error << '\n';
    return 1;
  }
  v2vouch::NoteDamage("v2vouch-replay", in, result.damaged);
  std::cout << (wants_json ? v2vouch::JsonReport(result) : v2vouch::TextReport(result));
  for (const std::string& note : result.verdict.notes) {
    std::cerr << "v2vouch-replay: note: " << note << '\n';
  }
  for (const std::string& problem : result.verdict.problems) {
    std::cerr << "v2vouch-replay: " << in << ": " << problem << '\n';
  }
  return result.verdict.problems.empty() ? 0 : 1;
}
