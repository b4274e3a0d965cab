// SPDX-License-Identifier: Apache-2.0
// v2vouch-log: records, and does with logs what users would build by hand.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/programs/log/csv.h"
#include "daemon/programs/log/log_edit.h"
#include "daemon/programs/log/recorder.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/output_file.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

namespace {

using v2vouch::kExitFailed;
using v2vouch::kExitGood;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-log record logs/ --keep-gb 200 --free 15
  v2vouch-log info drive.lcm
  v2vouch-log cut drive.lcm --from 12.5 --to 40 --out part.lcm
  v2vouch-log merge radar.lcm v2v.lcm --out both.lcm
  v2vouch-log filter drive.lcm --only 'RADAR_*' --only EGO_MOTION --out radar.lcm
  v2vouch-log to-csv tracks.lcm TRACKS_LOCAL --field utime --field tracks.id --field tracks.x_body_m

Exit codes: 0 good, 1 a log could not be read or written, or holds nothing of what was asked for,
2 usage.)";

struct Options {
  std::string in;
  std::vector<std::string> ins;
  std::string out;
  std::string url;
  std::string channel;
  std::vector<std::string> fields;
  v2vouch::LogFilter filter;
  double from_s = 0.0;
  double to_s = 0.0;
  double file_mb = 1024.0;
  double keep_gb = 0.0;
  double keep_hours = 0.0;
  double free_percent = 10.0;
  bool wants_json = false;
};

int Fail(const std::string& error) {
  std::cerr << "v2vouch-log: " << error << '\n';
  return kExitFailed;
}

int Record(const Options& options) {
  std::error_code error;
  std::filesystem::create_directories(options.in, error);
  if (!std::filesystem::is_directory(options.in, error)) return Fail(options.in + ": is no folder");
  v2vouch::HandleStopSignals();
  v2vouch::RecorderLimits limits;
  limits.file_bytes = static_cast<std::int64_t>(options.file_mb * 1e6);
  limits.total_bytes = static_cast<std::int64_t>(options.keep_gb * 1e9);
  limits.age = std::chrono::seconds(static_cast<std::int64_t>(options.keep_hours * 3600.0));
  limits.free_share = options.free_percent / 100.0;
  v2vouch::Recorder recorder(options.in, limits);
  std::unique_ptr<v2vouch::LcmBus> bus;
  while (!v2vouch::IsStopAsked()) {
    bus = v2vouch::LcmBus::Open(options.url);
    const auto write = [&](std::string_view channel, std::span<const std::uint8_t> bytes,
                           v2vouch::Timestamp received) {
      recorder.Write(received, channel, bytes, v2vouch::Recorder::Clock::now());
    };
    if (bus && bus->SubscribeAll(write)) break;
    bus.reset();
    std::cerr << "v2vouch-log: waiting for the LCM bus: is there a multicast route?\n";
    usleep(500'000);
  }
  bool was_paused = false;
  while (bus && !v2vouch::IsStopAsked()) {
    bus->Handle(100);
    recorder.Tick(v2vouch::Recorder::Clock::now());
    if (recorder.is_paused() == was_paused) continue;
    was_paused = recorder.is_paused();
    std::cerr << "v2vouch-log: "
              << (was_paused ? "paused: " + recorder.problem() : std::string("goes on")) << '\n';
  }
  recorder.Finish();
  std::fprintf(stderr, "%" PRId64 " messages recorded, %" PRId64 " missed\n", recorder.written(),
               recorder.missed());
  return recorder.missed() == 0 ? kExitGood : kExitFailed;
}

double Seconds(std::int64_t from_us, std::int64_t to_us) {
  return static_cast<double>(to_us - from_us) * 1e-6;
}

int Info(const Options& options) {
  std::string error;
  const auto info = v2vouch::ReadLogInfo(options.in, error);
  if (!info) return Fail(error);
  const double duration_s = Seconds(info->first_us, info->last_us);
  if (options.wants_json) {
    nlohmann::ordered_json all{{"events", info->events},        {"bytes", info->bytes},
                               {"first_utime", info->first_us}, {"duration_s", duration_s},
                               {"damaged", info->damaged},      {"steps_back", info->steps_back}};
    for (const auto& [name, each] : info->channels) {
      all["channels"][name] = {{"messages", each.messages},
                               {"bytes", each.bytes},
                               {"type", each.type},
                               {"longest_gap_s", each.longest_gap_s}};
    }
    std::cout << all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    return kExitGood;
  }
  std::printf("%" PRId64 " events, %.1f s, %.1f MB; damaged stretches %" PRId64
              ", steps back in time %" PRId64 "\n",
              info->events, duration_s, static_cast<double>(info->bytes) * 1e-6, info->damaged,
              info->steps_back);
  std::printf("%-28s %-22s %9s %8s %8s %9s\n", "channel", "type", "messages", "Hz", "kB", "gap_s");
  for (const auto& [name, each] : info->channels) {
    const double span_s = Seconds(each.first_us, each.last_us);
    std::printf("%-28s %-22s %9" PRId64 " %8.1f %8.0f %9.2f\n", name.c_str(),
                each.type.empty() ? "?" : each.type.c_str(), each.messages,
                span_s > 0.0 ? static_cast<double>(each.messages - 1) / span_s : 0.0,
                static_cast<double>(each.bytes) * 1e-3, each.longest_gap_s);
  }
  return kExitGood;
}

// Why nothing was copied: what the log has instead.
std::string WhatThereIs(const Options& options) {
  std::string error;
  const auto info = v2vouch::ReadLogInfo(options.in, error);
  if (!info) return "";
  if (options.filter.channels.empty() && options.filter.without.empty()) {
    char text[64];
    std::snprintf(text, sizeof text, "; it lasts %.1f s", Seconds(info->first_us, info->last_us));
    return text;
  }
  std::vector<std::string> names;
  for (const auto& [name, each] : info->channels) names.push_back(name);
  std::string text = "; it holds " + v2vouch::Listed(names);
  for (const std::string& wanted : options.filter.channels) {
    const std::string hint = v2vouch::DidYouMean(wanted, names);
    if (!hint.empty()) text += "; " + wanted + hint;
  }
  return text;
}

int Told(const std::optional<v2vouch::CopiedLog>& copied, const Options& options,
         const std::string& error) {
  if (!copied) return Fail(error);
  for (std::size_t i = 0; i < copied->damaged.size(); ++i) {
    v2vouch::NoteDamage("v2vouch-log", options.ins.empty() ? options.in : options.ins[i],
                        copied->damaged[i]);
  }
  std::fprintf(stderr, "%" PRId64 " events\n", copied->events);
  if (copied->events > 0) return kExitGood;
  return Fail("nothing of " + options.in + " fits, so " + options.out + " is empty" +
              WhatThereIs(options));
}

int Csv(const Options& options) {
  std::string error;
  std::FILE* file = stdout;
  const std::vector<std::string> inputs{options.in};
  if (!options.out.empty()) file = v2vouch::OpenOutput(options.out, inputs, error);
  if (file == nullptr) return Fail(error);
  const auto table = v2vouch::WriteCsv(options.in, options.channel, options.fields, file, error);
  const bool is_written = std::fflush(file) == 0 && std::ferror(file) == 0;
  if (!options.out.empty()) std::fclose(file);
  if (!table) return Fail(error);
  v2vouch::NoteDamage("v2vouch-log", options.in, table->damaged);
  if (table->unreadable > 0) {
    std::fprintf(stderr,
                 "v2vouch-log: note: %s: %" PRId64
                 " messages of %s, damaged or of another type, are left out\n",
                 options.in.c_str(), table->unreadable, options.channel.c_str());
  }
  if (options.out.empty()) return kExitGood;  // Of standard output the guard tells.
  return is_written ? kExitGood : Fail("the table cannot be written");
}

CLI::App* Add(CLI::App& app, const char* name, const char* what, Options& options) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->add_option("-l,--lcm-url", options.url,
                  name == std::string("record") ? "LCM URL (default: LCM_DEFAULT_URL)"
                                                : "Taken like every program's; no socket is opened")
      ->check(v2vouch::CheckLcmUrl);
  return sub;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-log");
  Options options;
  CLI::App app("Records LCM logs, and shows, cuts, merges, filters and tabulates them.");
  app.footer(kExamples);
  app.require_subcommand(1);
  CLI::App* record = Add(app, "record", "Every message of a bus into files of a folder", options);
  record->add_option("FOLDER", options.in, "Where the files go")->required();
  record->add_option("--file-mb", options.file_mb, "Size at which the next file begins")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 1e6));
  record->add_option("--keep-gb", options.keep_gb, "Remove own oldest files above this; 0: never")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  record
      ->add_option("--keep-hours", options.keep_hours, "Remove own files older than this; 0: never")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  record->add_option("--free", options.free_percent, "Percent of the disk that stay free")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 99.0));
  CLI::App* info = Add(app, "info", "What is in a log", options);
  info->add_flag("--json", options.wants_json, "Print the figures as JSON");
  CLI::App* cut = Add(app, "cut", "A stretch of time", options);
  CLI::Option* from = cut->add_option("--from", options.from_s, "Seconds after the first event");
  CLI::Option* to = cut->add_option("--to", options.to_s, "Seconds after the first event");
  CLI::App* merge = Add(app, "merge", "Several logs as one, in the order of recording", options);
  merge->add_option("IN", options.ins, "Logs")->required();
  CLI::App* filter = Add(app, "filter", "Some channels", options);
  filter->add_option("--only", options.filter.channels, "Channels to keep, with * and ?");
  filter->add_option("--without", options.filter.without, "Channels to leave out, with * and ?");
  CLI::App* csv = Add(app, "to-csv", "Any fields of a channel as a table", options);
  for (CLI::App* sub : {info, cut, filter, csv}) {
    sub->add_option("IN", options.in, "Log to read")->required();
  }
  for (CLI::App* sub : {cut, merge, filter}) {
    sub->add_option("--out", options.out, "Log to write")->required();
  }
  csv->add_option("CHANNEL", options.channel, "Channel")->required();
  csv->add_option("--field", options.fields,
                  "Field, as in tracks.x_body_m or covariance[3]; default: all that are no list");
  csv->add_option("--out", options.out, "File to write (default: standard output)");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-log", argc, argv)) return *code;

  std::string error;
  if (record->parsed()) return Record(options);
  if (info->parsed()) return Info(options);
  if (csv->parsed()) return Csv(options);
  if (merge->parsed()) {
    const auto copied = v2vouch::MergeLogs(options.ins, options.out, error);
    return Told(copied, options, error);
  }
  if (from->count() > 0 && to->count() > 0 && options.to_s <= options.from_s) {
    std::cerr << "v2vouch-log: --to must be above --from\n";
    return v2vouch::kExitUsage;
  }
  if (from->count() > 0) options.filter.from_s = options.from_s;
  if (to->count() > 0) options.filter.to_s = options.to_s;
  const auto copied = v2vouch::CopyLog(options.in, options.out, options.filter, error);
  return Told(copied, options, error);
}
