// SPDX-License-Identifier: Apache-2.0
// v2vouch-warn: warnings from the track lists, live or over a log.
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "daemon/programs/warn/warn_live.h"
#include "daemon/programs/warn/warn_log.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouch-warn                                       live: TRACKS_LOCAL, TRACKS_PRIORITY, EGO_MOTION and
                                                     EGO_INTENT in, WARNINGS out
  v2vouch-warn --quiet --config warn.yaml            the same, nothing printed
  v2vouch-warn result.lcm                            over a log that v2vouch-replay or a recorder wrote
  v2vouch-warn result.lcm --out warned.lcm --json    all its events and the warnings, figures as JSON
  v2vouch-warn --print-config                        every setting with its default

The same log and configuration give the same bytes. Vehicles that only their radio vouches for raise
nothing. Exit codes: 0 done; 1 a log cannot be read or written or holds no list, the bus cannot be
opened, or stopped over a log; 2 usage or configuration.)";

bool ShowProgress(double share) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  static int shown = -1;
  const int percent = static_cast<int>(100.0 * share);
  if (is_terminal && percent != shown) {
    std::fprintf(stderr, "\rwarning %3d %%", percent);
    shown = percent;
  }
  return !v2vouch::IsStopAsked();
}

int OverLog(const std::string& in, const std::string& out, const v2vouch::WarnFile& file,
            bool as_json) {
  v2vouch::WarnResult result;
  std::string error;
  const bool is_done = v2vouch::WarnOverLog(in, out, file, ShowProgress, result, error);
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  if (!is_done) {
    std::cerr << "v2vouch-warn: " << error << '\n';
    return 1;
  }
  v2vouch::NoteDamage("v2vouch-warn", in, result.damaged);
  std::cout << (as_json ? v2vouch::WarnJson(result) : v2vouch::WarnText(result));
  if (result.lists > 0) return 0;
  std::cerr << "v2vouch-warn: " << in << ": no list on " << file.channels.tracks_local << " or "
            << file.channels.tracks_priority << "; `v2vouch-replay LOG --out OUT` makes them\n";
  return 1;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  v2vouch::GuardStandardStreams("v2vouch-warn");
  std::string in;
  std::string out;
  std::string config_path;
  std::string lcm_url;
  bool as_json = false;
  bool is_quiet = false;
  bool prints_config = false;
  CLI::App app("Warns of vehicles that own sensors have seen: FCW, EEBL, IMA, LTA, BSW, LCW.");
  app.footer(kExamples);
  auto* log = app.add_option("LOG", in, "LCM log with track lists; without it: live");
  app.add_option("--out", out, "LCM log to write: all events and the warnings")->needs(log);
  app.add_option("--config", config_path, "Sections vehicle, channels, warnings");
  app.add_flag("--json", as_json, "Print the figures as JSON")->needs(log);
  app.add_flag("--quiet", is_quiet, "Live: print no line per warning");
  app.add_flag("--print-config", prints_config, "Print the configuration in force and end");
  app.add_option("-l,--lcm-url", lcm_url, "LCM URL (default: LCM_DEFAULT_URL)")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-warn", argc, argv)) return *code;

  v2vouch::WarnFile file;
  std::vector<std::string> problems;
  if (!v2vouch::LoadWarnFile(config_path, file, problems)) {
    for (const std::string& problem : problems) std::cerr << problem << '\n';
    return 2;
  }
  if (prints_config) {
    std::cout << v2vouch::PrintWarnFile(file);
    return 0;
  }
  v2vouch::HandleStopSignals();
  return in.empty() ? v2vouch::WarnLive(lcm_url, file, !is_quiet) : OverLog(in, out, file, as_json);
}
