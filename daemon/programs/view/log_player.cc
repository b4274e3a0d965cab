// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/view/log_player.h"

#include <algorithm>

#include "daemon/rim/wire/codec.h"
#include "v2vouch/text_t.hpp"

namespace v2vouch {
namespace {

using std::chrono::steady_clock;
using Status = view::PlaybackState::Status;

constexpr std::int64_t kMarkEvery_us = 250'000;
constexpr std::int64_t kMarkBytes = 1 << 22;  // Long pictures: a mark more often.
// The status comes once a second, a trail of some length takes longer.
constexpr std::int64_t kBeforeTarget_us = 6'000'000;
constexpr std::chrono::milliseconds kMostWork{
    30};  // Per call, so that clients are not kept waiting.

}  // namespace

std::string ConfigIn(const std::string& log) {
  std::string ignored;
  const auto reader = LogReader::Open(log, ignored);
  LogEvent event;
  constexpr int kFirstEvents = 1000;
  for (int i = 0; reader && i < kFirstEvents && reader->Next(event); ++i) {
    if (event.channel != wire::ChannelNames{}.config) continue;
    const auto message = wire::Decode<text_t>(event.bytes);
    if (message) return message->text;
  }
  return {};
}

std::unique_ptr<LogPlayer> LogPlayer::Open(const std::string& path, view::Scene& scene,
                                           const Progress& progress, std::string& error) {
  auto reader = LogReader::Open(path, error);
  if (!reader) return nullptr;
  std::unique_ptr<LogPlayer> player(new LogPlayer(std::move(reader), scene));
  if (!player->Index(progress)) {
    error = path + ": stopped";
    return nullptr;
  }
  player->Seek(player->state_.begin_us);
  player->state_.seeks = 0;
  return player;
}

bool LogPlayer::Index(const Progress& progress) {
  LogEvent event;
  std::int64_t offset = reader_->offset();
  std::int64_t newest = 0;
  std::int64_t count = 0;
  while (reader_->Next(event)) {
    const ArrivalClock before = clock_;
    newest = ToMicros(clock_.Of(event.received));
    if (marks_.empty() || newest - marks_.back().received_us >= kMarkEvery_us ||
        offset - marks_.back().offset >= kMarkBytes) {
      marks_.push_back({newest, offset, before});
    }
    // All but what only the picture of the moment needs.
    const std::string& channel = event.channel;
    if (!channel.starts_with("RADAR_") && !channel.starts_with("CAMERA_") &&
        !channel.starts_with("OBJECTS_") && !channel.starts_with("EGO_") && channel != "TRUTH") {
      scene_.Take(channel, event.bytes, FromMicros(newest));
    }
    offset = reader_->offset();
    if (++count % 4096 == 0 && !progress(reader_->progress())) return false;
  }
  damaged_ = reader_->damaged();
  has_lists_ = scene_.list_utime() != 0;
  scene_.events().Freeze();
  state_.begin_us = marks_.empty() ? 0 : marks_.front().received_us;
  state_.end_us = newest;
  return true;
}

void LogPlayer::Control(const view::PlaybackRequest& request) {
  if (request.seek_us) {
    Seek(*request.seek_us);
  } else if (request.play && state_.status == Status::kEnded) {
    Seek(state_.begin_us);
  }
  state_.speed = request.speed;
  if (state_.status != Status::kEnded || !request.play) {
    state_.status = request.play ? Status::kPlaying : Status::kPaused;
  }
  ++state_.changes;
}

void LogPlayer::Seek(std::int64_t target_us) {
  const std::int64_t target = std::clamp(target_us, state_.begin_us, state_.end_us);
  const auto after =
      std::ranges::upper_bound(marks_, target - kBeforeTarget_us, {}, &Mark::received_us);
  scene_.Forget();
  if (!marks_.empty()) {
    const Mark& mark = after == marks_.begin() ? marks_.front() : *std::prev(after);
    reader_->SeekTo(mark.offset);
    clock_ = mark.clock;
  }
  has_next_ = false;
  state_.now_us = target;
  ++state_.seeks;
  ++state_.changes;
  if (state_.status == Status::kEnded) state_.status = Status::kPaused;
  constexpr std::chrono::seconds kMostForSeek{2};
  PlayUntil(target, steady_clock::now() + kMostForSeek);
}

// False where the deadline came first.
bool LogPlayer::PlayUntil(std::int64_t target_us, steady_clock::time_point deadline) {
  for (int count = 0;; ++count) {
    if (!has_next_) {
      has_next_ = reader_->Next(next_);
      if (!has_next_) return true;
      next_.received = clock_.Of(next_.received);
    }
    if (ToMicros(next_.received) > target_us) return true;
    scene_.Take(next_.channel, next_.bytes, next_.received);
    has_next_ = false;
    if (count % 16 == 15 && steady_clock::now() > deadline) return false;
  }
}

void LogPlayer::Advance(steady_clock::time_point now) {
  const double elapsed_s = std::chrono::duration<double>(now - advanced_).count();
  advanced_ = now;
  if (state_.status != Status::kPlaying) return;
  // A machine that slept does not jump on.
  const double step_s = std::clamp(elapsed_s, 0.0, 0.25) * state_.speed;
  const std::int64_t target =
      std::min(state_.end_us, state_.now_us + static_cast<std::int64_t>(step_s * 1e6));
  const bool is_there = PlayUntil(target, now + kMostWork);
  // Where reading is too slow for the speed asked for, time goes on as fast as it can.
  state_.now_us = is_there ? target : std::clamp(scene_.list_received(), state_.now_us, target);
  if (state_.now_us >= state_.end_us) {
    state_.status = Status::kEnded;
    ++state_.changes;
  }
}

}  // namespace v2vouch
