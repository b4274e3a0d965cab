// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/log_edit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <queue>
#include <tuple>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/type_table.h"

namespace v2vouch {
namespace {

bool FitsAny(const std::string& name, const std::vector<std::string>& patterns) {
  return std::ranges::any_of(patterns,
                             [&](const std::string& each) { return FitsPattern(name, each); });
}

// Whether no event was recorded before the one in front of it; nullopt where it cannot be read.
std::optional<bool> IsSorted(const std::string& path, std::string& error) {
  const auto reader = LogReader::Open(path, error);
  if (!reader) return std::nullopt;
  LogEvent event;
  std::optional<Timestamp> before;
  while (reader->Next(event)) {
    if (before && event.received < *before) return false;
    before = event.received;
  }
  return true;
}

// A log's events in the order of their times. One that steps back in time is held in memory whole.
class OrderedLog {
 public:
  static std::unique_ptr<OrderedLog> Open(const std::string& path, std::string& error) {
    const auto is_sorted = IsSorted(path, error);
    if (!is_sorted) return nullptr;
    auto log = std::make_unique<OrderedLog>();
    log->reader_ = LogReader::Open(path, error);
    if (!log->reader_) return nullptr;
    if (!*is_sorted) {
      LogEvent event;
      while (log->reader_->Next(event)) log->held_.push_back(event);
      std::ranges::stable_sort(log->held_, {}, &LogEvent::received);
    }
    log->Advance();
    return log;
  }
  [[nodiscard]] bool is_over() const { return is_over_; }
  [[nodiscard]] std::int64_t damaged() const { return reader_->damaged(); }
  [[nodiscard]] const LogEvent& event() const { return event_; }
  void Advance() {
    if (held_.empty()) {
      is_over_ = !reader_->Next(event_);
    } else if (next_ < held_.size()) {
      event_ = held_[next_++];
    } else {
      is_over_ = true;
    }
  }

 private:
  std::unique_ptr<LogReader> reader_;
  std::vector<LogEvent> held_;
  std::size_t next_ = 0;
  LogEvent event_;
  bool is_over_ = false;
};

}  // namespace

bool FitsPattern(const std::string& name, const std::string& pattern) {
  // The last * is tried with one letter more whenever the rest does not fit.
  std::size_t n = 0, p = 0, star = std::string::npos, star_n = 0;
  while (n < name.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]) && pattern[p] != '*') {
      ++n, ++p;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_n = n;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++star_n;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::optional<LogInfo> ReadLogInfo(const std::string& path, std::string& error) {
  const auto reader = LogReader::Open(path, error);
  if (!reader) return std::nullopt;
  LogInfo info;
  LogEvent event;
  std::int64_t before = 0;
  while (reader->Next(event)) {
    const std::int64_t utime = ToMicros(event.received);
    if (info.events == 0) info.first_us = info.last_us = utime;
    if (info.events > 0 && utime < before) ++info.steps_back;
    before = utime;
    info.first_us = std::min(info.first_us, utime);
    info.last_us = std::max(info.last_us, utime);
    ++info.events;
    info.bytes += static_cast<std::int64_t>(event.bytes.size());
    LogInfo::Channel& channel = info.channels[event.channel];
    if (channel.messages == 0) {
      channel.first_us = utime;
    } else {
      channel.longest_gap_s =
          std::max(channel.longest_gap_s, static_cast<double>(utime - channel.last_us) * 1e-6);
    }
    channel.last_us = utime;
    ++channel.messages;
    channel.bytes += static_cast<std::int64_t>(event.bytes.size());
    const wire::WireType* type = wire::TypeOf(event.bytes);
    channel.type = type ? std::string(type->layout->name) : "";
  }
  info.damaged = reader->damaged();
  return info;
}

std::optional<CopiedLog> CopyLog(const std::string& in, const std::string& out,
                                 const LogFilter& filter, std::string& error) {
  const auto reader = LogReader::Open(in, error);
  if (!reader) return std::nullopt;
  const std::vector<std::string> inputs{in};
  const auto writer = LogWriter::Create(out, error, inputs);
  if (!writer) return std::nullopt;
  LogEvent event;
  std::optional<std::int64_t> first;
  CopiedLog copied;
  while (writer->is_good() && reader->Next(event)) {
    const std::int64_t utime = ToMicros(event.received);
    if (!first) first = utime;
    if (filter.from_s && utime - *first < std::llround(*filter.from_s * 1e6)) continue;
    if (filter.to_s && utime - *first >= std::llround(*filter.to_s * 1e6)) continue;
    if (!filter.channels.empty() && !FitsAny(event.channel, filter.channels)) continue;
    if (FitsAny(event.channel, filter.without)) continue;
    writer->Write(event.received, event.channel, event.bytes);
    ++copied.events;
  }
  copied.damaged = {reader->damaged()};
  if (!writer->Close(error)) return std::nullopt;  // A pipe that is gone included.
  return copied;
}

std::optional<CopiedLog> MergeLogs(const std::vector<std::string>& in, const std::string& out,
                                   std::string& error) {
  std::vector<std::unique_ptr<OrderedLog>> logs;
  for (const std::string& path : in) {
    auto log = OrderedLog::Open(path, error);
    if (!log) return std::nullopt;
    logs.push_back(std::move(log));
  }
  const auto writer = LogWriter::Create(out, error, in);
  if (!writer) return std::nullopt;
  using Next = std::tuple<std::int64_t, std::size_t>;  // Time, file.
  std::priority_queue<Next, std::vector<Next>, std::greater<>> queue;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    if (!logs[i]->is_over()) queue.emplace(ToMicros(logs[i]->event().received), i);
  }
  CopiedLog copied;
  while (writer->is_good() && !queue.empty()) {
    const std::size_t i = std::get<1>(queue.top());
    queue.pop();
    writer->Write(logs[i]->event().received, logs[i]->event().channel, logs[i]->event().bytes);
    ++copied.events;
    logs[i]->Advance();
    if (!logs[i]->is_over()) queue.emplace(ToMicros(logs[i]->event().received), i);
  }
  for (const auto& log : logs) copied.damaged.push_back(log->damaged());
  if (!writer->Close(error)) return std::nullopt;
  return copied;
}

}  // namespace v2vouch
