// SPDX-License-Identifier: Apache-2.0
#include "daemon/replay/replay.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "daemon/assembly/engine.h"
#include "daemon/io/event_log.h"

namespace v2vouch {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr std::int64_t kEventsPerProgress = 4096;

double Microseconds(SteadyClock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

bool IsOurOutput(const std::string& channel, const DaemonConfig& config) {
  const wire::ChannelNames& names = config.lcm.channels;
  if (channel == names.tracks_local || channel == names.tracks_priority ||
      channel == names.tracks_v2v || channel == names.status || channel == names.misbehavior ||
      channel == names.bsm_verdict || channel == names.config || channel == names.calibration) {
    return true;
  }
  // What our detector saw is made again where it looks at the pictures now.
  for (const CameraConfig& camera : config.perception.vehicle.cameras) {
    if (camera.source == CameraSource::kImage &&
        channel == names.camera_prefix + camera.name + names.detected_suffix) {
      return true;
    }
  }
  return false;
}

bool IsSameFile(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored);
}

void WriteAll(const Outbox& outbox, Timestamp at, LogWriter* writer) {
  if (writer == nullptr) return;
  for (const Outbox::Message& message : outbox.messages()) {
    writer->Write(at, message.channel, message.bytes);
  }
}

}  // namespace

bool Replay(const std::string& in, const std::string& out, const DaemonConfig& config,
            const std::function<bool(double)>& progress, ReplayResult& result, std::string& error) {
  const auto reader = LogReader::Open(in, error);
  if (!reader) return false;
  std::unique_ptr<LogWriter> writer;
  if (!out.empty()) {
    if (IsSameFile(in, out)) {
      error = out + ": is the log that is being read";
      return false;
    }
    writer = LogWriter::Create(out, error);
    if (!writer) return false;
  }

  const auto started = SteadyClock::now();
  Engine engine(config);
  Outbox outbox;
  LogEvent event;
  Timestamp first{};
  Timestamp last{};
  while (reader->Next(event)) {
    if (result.events == 0) {
      first = last = event.received;
      engine.Start(outbox);
      WriteAll(outbox, event.received, writer.get());
    }
    ++result.events;
    first = std::min(first, event.received);
    last = std::max(last, event.received);
    if (result.events % kEventsPerProgress == 0 && !progress(reader->progress())) {
      error = "stopped";
      return false;
    }
    if (IsOurOutput(event.channel, config)) {
      ++result.old_outputs;
      continue;
    }
    if (writer) writer->Write(event.received, event.channel, event.bytes);
    if (!engine.decoder().Find(event.channel)) {
      ++result.copied;
      continue;
    }
    ++result.inputs;
    outbox.Clear();
    const auto before = SteadyClock::now();
    engine.OnMessage(event.channel, event.bytes, event.received, outbox);
    result.step_us.push_back(Microseconds(SteadyClock::now() - before));
    if (engine.has_lists()) ++result.lists;
    WriteAll(outbox, event.received, writer.get());
  }
  result.wall_seconds = std::chrono::duration<double>(SteadyClock::now() - started).count();
  result.log_seconds = ToSeconds(last - first);
  result.damaged = reader->damaged();
  result.accepted = engine.accepted();
  result.refused = engine.refusals();
  result.digest_local = engine.digest_local();
  result.digest_priority = engine.digest_priority();
  return !writer || writer->Close(error);
}

}  // namespace v2vouch
