// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/base/time.h"

namespace v2vouch {

/// One event of an LCM log file.
struct LogEvent {
  std::int64_t number = 0;
  Timestamp received{};  ///< When it was recorded.
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// Reads the LCM event log format (sync word EDA1DA01, big endian). Own reader: liblcm's stops
/// silently at damage or trusts a bogus length. Here damage is counted and skipped to the next sync
/// word, lengths are bounded (channel 63 bytes, data 64 MiB), and a file that cannot be opened says
/// why.
class LogReader {
 public:
  /// @return nullptr with `error` set when the file cannot be opened or holds no event.
  static std::unique_ptr<LogReader> Open(const std::string& path, std::string& error);
  ~LogReader();

  /// The next event, reusing `event`'s buffers. False at the end.
  bool Next(LogEvent& event);
  /// Damaged stretches skipped so far.
  [[nodiscard]] std::int64_t damaged() const { return damaged_; }
  /// Share of the file read so far, 0..1, for progress.
  [[nodiscard]] double progress() const;

 private:
  LogReader() = default;
  std::FILE* file_ = nullptr;
  std::int64_t size_ = 0;
  std::int64_t damaged_ = 0;
};

/// Writes the same format; event numbers count from 0.
class LogWriter {
 public:
  static std::unique_ptr<LogWriter> Create(const std::string& path, std::string& error);
  ~LogWriter();

  void Write(Timestamp received, std::string_view channel, std::span<const std::uint8_t> bytes);
  /// Flushes and closes. @return false with `error` set when anything could not be written.
  bool Close(std::string& error);

 private:
  LogWriter() = default;
  std::FILE* file_ = nullptr;
  std::string path_;
  std::int64_t number_ = 0;
  bool failed_ = false;
};

}  // namespace v2vouch
