// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/recorder.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <utility>

#include "daemon/rim/io/log_format.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kBetweenLooks{1000};  // Free space and limits.
constexpr std::chrono::milliseconds kLongestWait{200};    // Of an event, before it is handed on.

double FreeShareOf(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error || space.capacity == 0) return 0.0;
  return static_cast<double>(space.available) / static_cast<double>(space.capacity);
}

// v2vouch-20261130-061500.00.lcm
bool IsOurs(const std::string& name) {
  static const std::string kForm = "v2vouch-########-######.##.lcm";
  return name.size() == kForm.size() &&
         std::equal(name.begin(), name.end(), kForm.begin(), [](char c, char form) {
           return form == '#' ? c >= '0' && c <= '9' : c == form;
         });
}

std::string NameFor(Recorder::Clock::time_point now, int number) {
  const std::time_t seconds = Recorder::Clock::to_time_t(now);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[64];
  const std::size_t length = std::strftime(text, sizeof(text), "v2vouch-%Y%m%d-%H%M%S", &utc);
  std::snprintf(text + length, sizeof(text) - length, ".%02d.lcm", number);
  return text;
}

}  // namespace

Recorder::Recorder(fs::path folder, RecorderLimits limits, FreeShare free_share)
    : folder_(std::move(folder)),
      limits_(limits),
      free_share_(free_share ? std::move(free_share) : FreeShare(FreeShareOf)) {}

Recorder::~Recorder() { Finish(); }

std::vector<fs::path> Recorder::OwnFiles() const {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    if (entry.is_regular_file(error) && IsOurs(entry.path().filename())) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);  // Their names are times.
  return files;
}

// Removes the oldest files that the limits no longer allow; never the one that is open.
void Recorder::MakeRoom(Clock::time_point now) {
  if (limits_.total_bytes == 0 && limits_.age.count() == 0) return;
  std::vector<std::pair<fs::path, std::int64_t>> files;
  std::int64_t total = 0;
  std::error_code error;
  for (const fs::path& path : OwnFiles()) {
    const auto bytes = static_cast<std::int64_t>(fs::file_size(path, error));
    files.emplace_back(path, error ? 0 : bytes);
    total += files.back().second;
  }
  for (const auto& [path, bytes] : files) {
    if (path == open_) continue;
    const auto changed = fs::last_write_time(path, error);
    const auto age = fs::file_time_type::clock::now() - changed;
    const bool is_old = !error && limits_.age.count() > 0 && age > limits_.age;
    const bool is_too_much = limits_.total_bytes > 0 && total > limits_.total_bytes;
    if (!is_old && !is_too_much) continue;
    if (fs::remove(path, error)) total -= bytes;
  }
  static_cast<void>(now);
}

bool Recorder::OpenNext(Clock::time_point now) {
  for (int number = 0; number < 100; ++number) {
    open_ = folder_ / NameFor(now, number);
    std::error_code error;
    if (fs::exists(fs::symlink_status(open_, error))) continue;  // Nothing is overwritten.
    writer_ = LogWriter::Create(open_.string(), problem_);
    open_bytes_ = 0;
    flushed_ = now;
    return writer_ != nullptr;
  }
  problem_ = folder_.string() + ": a hundred files in one second";
  return false;
}

void Recorder::Finish() {
  if (!writer_) return;
  std::string error;
  if (!writer_->Close(error)) {
    problem_ = error;
    CountLost();
  }
  writer_.reset();
  open_.clear();
  waiting_.clear();
}

// Of a file that took no more: the events beyond its end.
void Recorder::CountLost() {
  std::error_code error;
  const auto size = fs::file_size(open_, error);
  const auto lost = std::ranges::count_if(
      waiting_, [&](std::int64_t end) { return error || end > static_cast<std::int64_t>(size); });
  written_ -= lost;
  missed_ += lost;
}

void Recorder::Tick(Clock::time_point now) {
  if (!writer_ || waiting_.empty()) return;
  if (now - flushed_ < kLongestWait && now >= flushed_) return;
  flushed_ = now;
  if (writer_->Flush()) {
    waiting_.clear();
  } else {  // A full disk. Its whole events stay readable.
    Finish();
    is_paused_ = true;
  }
}

// Once a second: limits, and whether there is space.
void Recorder::Look(Clock::time_point now) {
  if (now - looked_ < kBetweenLooks && now >= looked_) return;
  looked_ = now;
  MakeRoom(now);
  const double share = free_share_(folder_);
  if (share <= limits_.free_share) {
    if (!is_paused_) {
      char text[96];
      std::snprintf(text, sizeof(text), ": %.1f %% of the disk are free, %.1f %% stay free",
                    100.0 * share, 100.0 * limits_.free_share);
      Finish();
      problem_ = folder_.string() + text;
    }
    is_paused_ = true;
  } else {
    is_paused_ = false;
  }
}

void Recorder::Write(Timestamp received, std::string_view channel,
                     std::span<const std::uint8_t> bytes, Clock::time_point now) {
  if (channel.empty() || channel.size() > kMaxChannelLength || bytes.size() > kMaxEventBytes) {
    ++missed_;
    return;
  }
  Look(now);
  if (!is_paused_ && open_bytes_ >= limits_.file_bytes) Finish();
  if (is_paused_ || (!writer_ && !OpenNext(now))) {
    is_paused_ = true;
    ++missed_;
    return;
  }
  writer_->Write(received, channel, bytes);
  open_bytes_ +=
      static_cast<std::int64_t>(log_format::kHeaderBytes + channel.size() + bytes.size());
  waiting_.push_back(open_bytes_);
  ++written_;
  if (writer_->is_good()) return Tick(now);
  Finish();
  is_paused_ = true;
}

}  // namespace v2vouch
