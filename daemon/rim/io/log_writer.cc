// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cerrno>
#include <cstring>

#include "daemon/common/base/check.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/log_format.h"
#include "daemon/rim/io/output_file.h"

namespace v2vouch {

using log_format::Store;

std::unique_ptr<LogWriter> LogWriter::Create(const std::string& path, std::string& error,
                                             std::span<const std::string> inputs) {
  std::FILE* file = OpenOutput(path, inputs, error);
  if (file == nullptr) return nullptr;
  // Lists are written every few milliseconds of a log: fewer, larger writes.
  std::setvbuf(file, nullptr, _IOFBF, 1U << 18);
  std::unique_ptr<LogWriter> writer(new LogWriter);
  writer->file_ = file;
  writer->path_ = path;
  return writer;
}

LogWriter::~LogWriter() {
  if (file_ != nullptr) std::fclose(file_);
}

void LogWriter::Write(Timestamp received, std::string_view channel,
                      std::span<const std::uint8_t> bytes) {
  WriteNumbered(number_++, received, channel, bytes);
}

void LogWriter::Write(const LogEvent& event) {
  WriteNumbered(event.number, event.received, event.channel, event.bytes);
}

void LogWriter::WriteNumbered(std::int64_t number, Timestamp received, std::string_view channel,
                              std::span<const std::uint8_t> bytes) {
  V2VOUCH_CHECK(file_ != nullptr);
  V2VOUCH_CHECK(!channel.empty() && channel.size() <= kMaxChannelLength);
  V2VOUCH_CHECK(bytes.size() <= kMaxEventBytes);
  std::array<std::uint8_t, log_format::kHeaderBytes> header{};
  Store(header.data(), log_format::kSyncWord);
  Store(header.data() + 4, number);
  Store(header.data() + 12, ToMicros(received));
  Store(header.data() + 20, static_cast<std::uint32_t>(channel.size()));
  Store(header.data() + 24, static_cast<std::uint32_t>(bytes.size()));
  const bool good =
      std::fwrite(header.data(), 1, header.size(), file_) == header.size() &&
      std::fwrite(channel.data(), 1, channel.size(), file_) == channel.size() &&
      (bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size());
  if (!good && errno_ == 0) errno_ = errno;
}

bool LogWriter::Flush() {
  V2VOUCH_CHECK(file_ != nullptr);
  if (std::fflush(file_) != 0 && errno_ == 0) errno_ = errno;
  return is_good();
}

bool LogWriter::Close(std::string& error) {
  V2VOUCH_CHECK(file_ != nullptr);
  // A full disk often shows only when the last buffer goes out.
  if (std::fflush(file_) != 0 && errno_ == 0) errno_ = errno;
  if (std::fclose(file_) != 0 && errno_ == 0) errno_ = errno;
  file_ = nullptr;
  if (errno_ == 0) return true;
  error = path_ + ": " + std::strerror(errno_);
  return false;
}

}  // namespace v2vouch
