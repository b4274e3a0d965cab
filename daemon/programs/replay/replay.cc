// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/replay/replay.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <utility>

#include "daemon/rim/engine/engine.h"
#include "daemon/rim/engine/trust_file.h"
#include "daemon/rim/io/event_log.h"

namespace v2vouch {
namespace {

using SteadyClock = std::chrono::steady_clock;

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
  return false;
}

// What the network saw is taken from the log; the pictures only pass through.
DaemonConfig WithoutNetwork(DaemonConfig config) {
  for (CameraConfig& camera : config.perception.vehicle.cameras) {
    if (camera.source == CameraSource::kImage) camera.source = CameraSource::kDetected;
  }
  return config;
}

// Pictures that came without what a network saw in them, over all cameras.
class UnseenPictures {
 public:
  explicit UnseenPictures(const DaemonConfig& config) {
    const wire::ChannelNames& names = config.lcm.channels;
    for (const CameraConfig& camera : config.perception.vehicle.cameras) {
      if (camera.source != CameraSource::kDetected) continue;
      pictures_[names.camera_prefix + camera.name + names.image_suffix] = cameras_;
      detections_[wire::DetectedChannel(names, camera)] = cameras_++;
    }
    balance_.resize(cameras_, 0);
  }
  void Note(const std::string& channel) {
    if (const auto found = pictures_.find(channel); found != pictures_.end()) {
      ++balance_[found->second];
    } else if (const auto seen = detections_.find(channel); seen != detections_.end()) {
      --balance_[seen->second];
    }
  }
  [[nodiscard]] std::int64_t count() const {
    std::int64_t sum = 0;
    for (const std::int64_t each : balance_) sum += std::max<std::int64_t>(0, each);
    return sum;
  }

 private:
  std::map<std::string, std::size_t> pictures_;
  std::map<std::string, std::size_t> detections_;
  std::size_t cameras_ = 0;
  std::vector<std::int64_t> balance_;
};

void Note(const std::vector<NoticeBoard::Change>& changes, std::vector<ReplayedNotice>& notices) {
  for (const NoticeBoard::Change& change : changes) {
    if (!change.has_begun) continue;
    const auto known = std::ranges::find_if(notices, [&](const ReplayedNotice& each) {
      return each.notice.name == change.notice.name && each.notice.channel == change.notice.channel;
    });
    if (known != notices.end()) {
      ++known->times;
    } else {
      notices.push_back({.notice = change.notice});
    }
  }
}

void WriteAll(const Outbox& outbox, Timestamp at, LogWriter* writer) {
  if (writer == nullptr) return;
  for (const Outbox::Message& message : outbox.messages()) {
    writer->Write(at, message.channel, message.bytes);
  }
}

// As old as it was when the log began: the same log gives the same bytes on any day.
bool RestoreTrust(const DaemonConfig& config, Timestamp begin, Engine& engine, std::string& error) {
  if (config.state.file.empty()) return true;
  LoadedTrust trust =
      LoadTrust(config.state.file, config.perception.vehicle.id, begin, config.state.max_age_s);
  error = trust.problem;
  if (!error.empty()) return false;
  engine.RestoreTrust(std::move(trust.senders));
  return true;
}

void Step(const LogEvent& event, Engine& engine, Outbox& outbox, ChannelFigures& channel,
          ReplayResult& result) {
  ++result.inputs;
  outbox.Clear();
  const std::int64_t accepted_before = engine.accepted();
  const ReasonCounts refused_before = engine.refusals();
  const auto before = SteadyClock::now();
  engine.OnMessage(event.channel, event.bytes, event.received, outbox);
  result.step_us.push_back(Microseconds(SteadyClock::now() - before));
  channel.accepted += engine.accepted() - accepted_before;
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    const std::uint64_t more = engine.refusals()[i] - refused_before[i];
    if (more > 0) channel.refused[static_cast<Reason>(i)] += static_cast<std::int64_t>(more);
  }
  if (engine.has_lists()) ++result.lists;
  Note(engine.TakeNoticeChanges(), result.notices);
}

void TakeOutcome(const Engine& engine, const DaemonConfig& config, ReplayResult& result) {
  result.accepted = engine.accepted();
  result.refused = engine.refusals();
  result.verdict = JudgeChannels(result.channels, result.lists, config);
  result.refusal_details = engine.refusal_details();
  result.digest_local = engine.digest_local();
  result.digest_priority = engine.digest_priority();
}

}  // namespace

bool Replay(const std::string& in, const std::string& out, const DaemonConfig& given,
            const std::function<bool(double)>& progress, ReplayResult& result, std::string& error) {
  const DaemonConfig config = WithoutNetwork(given);
  const auto reader = LogReader::Open(in, error);
  if (!reader) return false;
  std::unique_ptr<LogWriter> writer;
  if (!out.empty()) {
    writer = LogWriter::Create(out, error, std::span(&in, 1));
    if (!writer) return false;
  }

  const auto started = SteadyClock::now();
  UnseenPictures unseen(config);
  Engine engine(config);
  Outbox outbox;
  LogEvent event;
  for (const auto& input : engine.channels()) {
    if (!input.is_optional()) result.channels[input.name].is_input = true;
  }
  Timestamp first{};
  Timestamp last{};
  while (reader->Next(event)) {
    if (result.events == 0) {
      first = last = event.received;
      if (!RestoreTrust(config, event.received, engine, error)) return false;
      engine.Start(outbox);
      WriteAll(outbox, event.received, writer.get());
    }
    ++result.events;
    first = std::min(first, event.received);
    last = std::max(last, event.received);
    if (!progress(reader->progress())) {
      error = "stopped";
      return false;
    }
    if (writer && !writer->is_good()) break;
    unseen.Note(event.channel);
    if (IsOurOutput(event.channel, config)) {
      ++result.old_outputs;
      continue;
    }
    ChannelFigures& channel = result.channels[event.channel];
    ++channel.received;
    if (writer) writer->Write(event.received, event.channel, event.bytes);
    if (!engine.decoder().Find(event.channel)) {
      ++result.copied;
      continue;
    }
    channel.is_input = true;
    Step(event, engine, outbox, channel, result);
    WriteAll(outbox, event.received, writer.get());
  }
  result.wall_seconds = std::chrono::duration<double>(SteadyClock::now() - started).count();
  result.log_seconds = ToSeconds(last - first);
  result.damaged = reader->damaged();
  result.unseen_pictures = unseen.count();
  TakeOutcome(engine, config, result);
  return !writer || writer->Close(error);
}

}  // namespace v2vouch
