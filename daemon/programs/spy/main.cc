// SPDX-License-Identifier: Apache-2.0
// v2vouch-spy: what is on an LCM bus, or in a log.
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/programs/spy/bus_listener.h"
#include "daemon/programs/spy/plain_words.h"
#include "daemon/programs/spy/printable.h"
#include "daemon/programs/spy/screen.h"
#include "daemon/programs/spy/spy_report.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/message_schema/json_text.h"
#include "daemon/rim/program/command_line.h"

namespace {

using namespace v2vouch;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-spy                              every channel of the bus, live; Enter opens one
  v2vouch-spy --once                       listen for 3 s, print the table, end
  v2vouch-spy --once --channel TRACKS_PRIORITY        the newest list as a table
  v2vouch-spy --once --channel V2VOUCH_STATUS         the daemon's state in words
  v2vouch-spy drive.lcm --json             the same figures of a recorded drive

Needs no graphics and no Java. Packets that are broken or hostile are counted, never trusted.

Exit codes: 0 good; 1 nothing was heard, the channel was not, or the log cannot be read; 2 usage.)";

struct Options {
  std::string log, channel, url;
  double seconds = 3.0;
  bool once = false, json = false;
};

int Print(const spy::Moment& moment, const Options& options) {
  if (!options.channel.empty()) {
    const spy::ChannelRow* row = moment.table->Find(options.channel);
    if (row == nullptr) {
      std::vector<std::string> heard;
      for (const auto& [name, each] : moment.table->rows()) heard.push_back(spy::Printable(name));
      std::cerr << "v2vouch-spy: nothing on " << options.channel
                << DidYouMean(options.channel, heard)
                << "; heard: " << (heard.empty() ? "nothing at all" : Listed(heard)) << '\n';
      return kExitFailed;
    }
    if (options.json) {
      const auto json =
          row->type != nullptr ? message_schema::JsonText(*row->type, row->newest) : std::nullopt;
      std::cout << json.value_or("null") << '\n';
      return json ? kExitGood : kExitFailed;
    }
    for (const std::string& line : spy::Describe(row->newest)) std::cout << line << '\n';
    return kExitGood;
  }
  if (options.json) {
    std::cout << spy::JsonOf(moment);
  } else {
    for (const std::string& line : spy::TableLines(moment)) std::cout << line << '\n';
    for (const std::string& line : spy::RefusalLines(moment)) std::cout << line << '\n';
  }
  if (moment.table->messages() > 0) return kExitGood;
  std::cerr << "v2vouch-spy: nothing was heard; is the URL right, and who sends?\n";
  return kExitFailed;
}

spy::Moment MomentOf(const spy::BusListener& bus) {
  return {.table = &bus.table(),
          .packets = bus.refused(),
          .kernel_drops = bus.kernel_drops(),
          .damaged = 0,
          .now_us = spy::BusListener::Now(),
          .is_log = false};
}

int SpyOnBus(const Options& options) {
  std::string error;
  const auto bus = spy::BusListener::Open(options.url, error);
  if (!bus) {
    std::cerr << "v2vouch-spy: " << error << '\n';
    return kExitFailed;
  }
  const bool is_screen = !options.once && !options.json && options.channel.empty() &&
                         isatty(STDOUT_FILENO) == 1 && isatty(STDIN_FILENO) == 1;
  if (!is_screen) {
    const auto end = spy::BusListener::Now() + static_cast<std::int64_t>(1e6 * options.seconds);
    while (spy::BusListener::Now() < end && !IsStopAsked()) bus->Listen(50, 50);
    return Print(MomentOf(*bus), options);
  }
  spy::Screen screen;
  std::int64_t drawn = 0;
  const std::string url = EffectiveLcmUrl(options.url);
  const std::string title = "v2vouch-spy  " + (url.empty() ? "LCM's default bus" : url);
  while (!IsStopAsked() && screen.TakeKeys(MomentOf(*bus))) {
    bus->Listen(50, 50);
    if (spy::BusListener::Now() - drawn < 150'000) continue;
    drawn = spy::BusListener::Now();
    screen.Draw(MomentOf(*bus), title);
  }
  return kExitGood;
}

int SpyOnLog(const Options& options) {
  std::string error;
  const auto log = LogReader::Open(options.log, error);
  if (!log) {
    std::cerr << "v2vouch-spy: " << error << '\n';
    return kExitFailed;
  }
  spy::ChannelTable table;
  LogEvent event;
  while (!IsStopAsked() && log->Next(event)) {
    table.Take(event.channel, event.bytes, ToMicros(event.received));
  }
  spy::Moment moment;
  moment.table = &table;
  moment.damaged = log->damaged();
  NoteDamage("v2vouch-spy", options.log, moment.damaged);
  moment.now_us = table.last_us();
  moment.is_log = true;
  const bool is_screen = !options.once && !options.json && options.channel.empty() &&
                         isatty(STDOUT_FILENO) == 1 && isatty(STDIN_FILENO) == 1;
  if (!is_screen) return Print(moment, options);
  spy::Screen screen;
  while (!IsStopAsked() && screen.TakeKeys(moment)) {
    screen.Draw(moment, "v2vouch-spy  " + options.log + "  (newest message of each channel)");
    usleep(100'000);
  }
  return kExitGood;
}

}  // namespace

int main(int argc, char** argv) {
  GuardStandardStreams("v2vouch-spy");
  Options options;
  CLI::App app("Shows what is on an LCM bus, or in a log: channels, rates, losses, values.");
  app.footer(kExamples);
  app.add_option("LOG", options.log, "LCM log instead of the bus");
  app.add_flag("--once", options.once, "Print once and end, instead of a screen");
  app.add_flag("--json", options.json, "Figures as JSON; ends like --once");
  app.add_option("--channel", options.channel, "Print the newest message of this channel");
  app.add_option("--seconds", options.seconds, "How long --once listens")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("-l,--lcm-url", options.url, "Bus (default: LCM_DEFAULT_URL)")->check(CheckLcmUrl);
  if (const auto code = ReadCommandLine(app, "v2vouch-spy", argc, argv)) return *code;
  HandleStopSignals();
  return options.log.empty() ? SpyOnBus(options) : SpyOnLog(options);
}
