// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/warn/warn_log.h"

#include <algorithm>
#include <chrono>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/warnings_wire/warnings_conversion.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch {
namespace {

int Rank(warnings::Level level) {
  return level == warnings::Level::kLost ? 0 : static_cast<int>(level);
}

}  // namespace

void NoteEpisodes(const warnings::WarningList& list, WarnResult& result) {
  const std::int64_t number = ++result.lists;
  result.degraded = number == 1 ? list.degraded : result.degraded & list.degraded;
  for (const warnings::Warning& warning : list.warnings) {
    const auto known = std::find_if(
        result.episodes.rbegin(), result.episodes.rend(), [&](const WarnEpisode& each) {
          return each.worst.kind == warning.kind && each.worst.since == warning.since &&
                 each.seen_in == number - 1;
        });
    if (known == result.episodes.rend()) {
      result.episodes.push_back({warning, list.stamp, number});
      continue;
    }
    known->until = list.stamp;
    known->seen_in = number;
    if (Rank(warning.level) > Rank(known->worst.level)) known->worst = warning;
  }
}

bool WarnOverLog(const std::string& in, const std::string& out, const WarnFile& file,
                 const std::function<bool(double)>& progress, WarnResult& result,
                 std::string& error) {
  const auto reader = LogReader::Open(in, error);
  if (!reader) return false;
  std::unique_ptr<LogWriter> writer;
  if (!out.empty()) {
    const std::vector<std::string> inputs = {in};
    writer = LogWriter::Create(out, error, inputs);
    if (!writer) return false;
  }
  wire::WarnFeed feed(file.channels, file.warnings, file.body());
  LogEvent event;
  std::vector<std::uint8_t> bytes;
  while (reader->Next(event)) {
    if (!progress(reader->progress())) {
      error = "stopped";
      return false;
    }
    if (result.events++ == 0) result.first = event.received;
    result.log_seconds = ToSeconds(event.received - result.first);
    if (event.channel == file.channels.warnings) {
      ++result.old_outputs;
      continue;
    }
    if (writer) writer->Write(event.received, event.channel, event.bytes);
    const auto before = std::chrono::steady_clock::now();
    const auto list = feed.Take(event.channel, event.bytes);
    if (!list) continue;
    const std::chrono::duration<double, std::micro> took =
        std::chrono::steady_clock::now() - before;
    result.step_us.push_back(took.count());
    NoteEpisodes(*list, result);
    if (!writer) continue;
    wire::Encode(wire::ToMessage(*list), bytes);
    writer->Write(event.received, file.channels.warnings, bytes);
    if (!writer->is_good()) break;
  }
  result.taken = feed.taken();
  result.refused = feed.refused();
  result.damaged = reader->damaged();
  return !writer || writer->Close(error);
}

}  // namespace v2vouch
