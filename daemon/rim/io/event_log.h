// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"

namespace v2vouch {

inline constexpr std::size_t kMaxChannelLength = 63;      ///< LCM's own limit.
inline constexpr std::size_t kMaxEventBytes = 64u << 20;  ///< Longer data in a log is damage.

/// One event of an LCM log file.
struct LogEvent {
  std::int64_t number = 0;
  Timestamp received{};  ///< When it was recorded.
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// Reads the LCM event log format. All integers big endian:
///
///     sync EDA1DA01 (4) | number (8) | microseconds (8) | channel length (4) | data length (4)
///     | channel | data
///
/// Own reader: liblcm's stops silently at damage or trusts a bogus length. Here damage is counted
/// and skipped to the next believable event, lengths are bounded (channel 63 bytes, data 64 MiB),
/// and a file that cannot be opened says why. An event whose length reaches over another believable
/// event, and whose own end meets none, has a damaged length and is skipped; the event in front of
/// a damaged stretch is kept.
class LogReader {
 public:
  /// @return nullptr with `error` set when the file cannot be opened or holds no event.
  static std::unique_ptr<LogReader> Open(const std::string& path, std::string& error);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next event, reusing `event`'s buffers. False at the end.
  bool Next(LogEvent& event);
  /// Where in the file the next event is looked for.
  [[nodiscard]] std::int64_t offset() const { return offset_; }
  /// Goes on there: an offset() of before, or any other, from which the next event is found.
  bool SeekTo(std::int64_t offset);
  /// Damaged stretches skipped so far.
  [[nodiscard]] std::int64_t damaged() const { return damaged_; }
  /// Share of the file read so far, 0..1, for progress.
  [[nodiscard]] double progress() const;

 private:
  LogReader() = default;

  bool Have(std::size_t bytes);
  const std::uint8_t* At(std::size_t offset) const { return window_.data() + begin_ + offset; }
  bool IsBelievable(std::size_t offset);
  bool HidesAnEvent(std::size_t length);
  void SkipDamage();

  std::FILE* file_ = nullptr;
  std::int64_t size_ = 0;    // Of the file when it was opened.
  std::int64_t offset_ = 0;  // Of the window's begin in the file.
  std::size_t begin_ = 0;    // Of what is not yet consumed in window_.
  std::vector<std::uint8_t> window_;
  std::int64_t damaged_ = 0;
};

/// Writes the same format; event numbers count from 0.
class LogWriter {
 public:
  /// @param inputs files that are read meanwhile: none of them is overwritten (output_file.h).
  static std::unique_ptr<LogWriter> Create(const std::string& path, std::string& error,
                                           std::span<const std::string> inputs = {});
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// `channel` has 1..63 bytes, `bytes` at most 64 MiB.
  void Write(Timestamp received, std::string_view channel, std::span<const std::uint8_t> bytes);
  /// The same with the event's own number, for copies that shall equal the original.
  void Write(const LogEvent& event);
  /// False once something could not be written; no use in going on then.
  [[nodiscard]] bool is_good() const { return errno_ == 0; }
  /// Hands everything so far to the system: no kill of this process loses it. @return is_good().
  bool Flush();
  /// Flushes and closes. @return false with `error` set when anything could not be written.
  bool Close(std::string& error);

 private:
  LogWriter() = default;
  void WriteNumbered(std::int64_t number, Timestamp received, std::string_view channel,
                     std::span<const std::uint8_t> bytes);
  std::FILE* file_ = nullptr;
  std::string path_;
  std::int64_t number_ = 0;
  int errno_ = 0;  // Of the first write that failed.
};

}  // namespace v2vouch
