// SPDX-License-Identifier: Apache-2.0
// v2vouch-mcap: LCM logs to MCAP files and back.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/programs/mcap/convert.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

namespace {

using v2vouch::mcap_export::ConvertResult;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-mcap tracks.lcm --out tracks.mcap             for Foxglove, Lichtblick, PlotJuggler
  v2vouch-mcap drive.lcm --raw --out drive.mcap         LCM's bytes, nothing lost
  v2vouch-mcap drive.mcap --out drive.lcm               back; byte for byte the log it came from

The view flavour holds JSON with a schema on every channel's name, and scenes, transforms, fixes,
pictures and log lines as Foxglove's own messages. Only the raw flavour can be turned back.
Files that a crash left are read up to where they break off.

Exit codes: 0 done; 1 the input could not be read, held nothing, or the output could not be written;
2 usage.)";

bool ShowProgress(double share) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  static int shown = -1;
  const int percent = static_cast<int>(100.0 * share);
  if (is_terminal && percent != shown) {
    std::fprintf(stderr, "\rconverting %3d %%", percent);
    shown = percent;
  }
  return !v2vouch::IsStopAsked();
}

void Print(const ConvertResult& result, const std::string& out, bool wants_json) {
  if (wants_json) {
    const nlohmann::json json = {
        {"made", result.made},         {"events", result.events},   {"messages", result.messages},
        {"left_out", result.left_out}, {"damaged", result.damaged}, {"chunks", result.chunks},
        {"bytes", result.bytes},       {"fault", result.fault},     {"notes", result.notes}};
    std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    return;
  }
  std::cout << out << ": " << result.messages << " messages of " << result.events << " events, "
            << std::round(static_cast<double>(result.bytes) / 1e5) / 10.0 << " MB\n";
}

}  // namespace

// What throws here is a lack of memory.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  v2vouch::GuardStandardStreams("v2vouch-mcap");
  std::string in;
  std::string out;
  std::string compression = "zstd";
  std::string lcm_url;
  bool is_raw = false;
  bool wants_json = false;
  CLI::App app("Turns an LCM log into an MCAP file, or a raw MCAP file back into an LCM log.");
  app.footer(kExamples);
  app.add_option("IN", in, "LCM log, or MCAP file made with --raw")->required();
  app.add_option("--out", out, "File to write")->required();
  app.add_flag("--raw", is_raw, "LCM's own bytes: can be turned back");
  app.add_option("--compression", compression, "Of the chunks: zstd or none")
      ->check(v2vouch::OneOf({"zstd", "none"}))
      ->capture_default_str();
  app.add_flag("--json", wants_json, "Print the figures as JSON");
  app.add_option("-l,--lcm-url", lcm_url, "Taken like every program's; no socket is opened")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-mcap", argc, argv)) return *code;

  v2vouch::HandleStopSignals();
  using namespace v2vouch::mcap_export;
  const ConvertOptions options{is_raw ? Flavour::kRaw : Flavour::kView,
                               compression == "none" ? v2vouch::mcap::Compression::kNone
                                                     : v2vouch::mcap::Compression::kZstd};
  ConvertResult result;
  std::string error;
  const bool is_done = IsMcap(in) ? McapToLog(in, out, ShowProgress, result, error)
                                  : LogToMcap(in, out, options, ShowProgress, result, error);
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  for (const std::string& note : result.notes) std::cerr << "v2vouch-mcap: note: " << note << '\n';
  if (!is_done) {
    std::cerr << "v2vouch-mcap: " << error << '\n';
    return v2vouch::kExitFailed;
  }
  Print(result, out, wants_json);
  return v2vouch::kExitGood;
}
