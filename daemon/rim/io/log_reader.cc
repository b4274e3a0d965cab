// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/log_format.h"

namespace v2vouch {
namespace {

using log_format::kHeaderBytes;
using log_format::kSyncWord;
using log_format::Load;

constexpr std::size_t kChunk = 1u << 20;

struct Lengths {
  std::size_t channel;
  std::size_t data;
  [[nodiscard]] std::size_t total() const { return kHeaderBytes + channel + data; }
};

Lengths LengthsOf(const std::uint8_t* header) {
  return {Load<std::uint32_t>(header + 20), Load<std::uint32_t>(header + 24)};
}

bool AreInRange(Lengths lengths) {
  return lengths.channel >= 1 && lengths.channel <= kMaxChannelLength &&
         lengths.data <= kMaxEventBytes;
}

}  // namespace

std::unique_ptr<LogReader> LogReader::Open(const std::string& path, std::string& error) {
  struct stat status {};
  // Opening a pipe would wait for a writer.
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
    error = path + ": is not a file";
    return nullptr;
  }
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr || fstat(fileno(file), &status) != 0) {
    error = path + ": " + std::strerror(errno);
    if (file != nullptr) std::fclose(file);
    return nullptr;
  }
  std::unique_ptr<LogReader> reader(new LogReader);
  reader->file_ = file;
  reader->size_ = status.st_size;
  if (!S_ISREG(status.st_mode)) {
    error = path + ": is not a file";
    return nullptr;
  }
  if (!reader->IsBelievable(0)) reader->SkipDamage();
  if (!reader->Have(kHeaderBytes)) {
    error = path + ": holds no LCM event";
    return nullptr;
  }
  return reader;
}

LogReader::~LogReader() {
  if (file_ != nullptr) std::fclose(file_);
}

double LogReader::progress() const {
  return size_ > 0 ? std::min(1.0, static_cast<double>(offset_) / static_cast<double>(size_)) : 1.0;
}

// Makes sure that so many bytes lie in the window; false where the file has fewer left.
bool LogReader::Have(std::size_t bytes) {
  if (window_.size() - begin_ >= bytes) return true;
  if (offset_ + static_cast<std::int64_t>(bytes) > size_) return false;
  window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  const std::size_t old_size = window_.size();
  const std::size_t wanted = std::max(kChunk, bytes - old_size);
  window_.resize(old_size + wanted);
  const std::size_t got = std::fread(window_.data() + old_size, 1, wanted, file_);
  window_.resize(old_size + got);
  return window_.size() >= bytes;
}

// Whether a header stands there whose event fits the rest of the file.
bool LogReader::IsBelievable(std::size_t offset) {
  if (!Have(offset + kHeaderBytes)) return false;
  const std::uint8_t* header = At(offset);
  if (Load<std::uint32_t>(header) != kSyncWord) return false;
  const Lengths lengths = LengthsOf(header);
  return AreInRange(lengths) &&
         offset_ + static_cast<std::int64_t>(offset + lengths.total()) <= size_;
}

bool LogReader::HidesAnEvent(std::size_t length) {
  for (std::size_t i = kHeaderBytes; i + kHeaderBytes <= length; ++i) {
    if (*At(i) == (kSyncWord >> 24) && IsBelievable(i)) return true;
  }
  return false;
}

void LogReader::SkipDamage() {
  ++damaged_;
  do {
    if (!Have(kHeaderBytes + 1)) {  // Nothing more can stand in what is left.
      offset_ = size_;
      begin_ = window_.size();
      return;
    }
    ++begin_;
    ++offset_;
  } while (*At(0) != (kSyncWord >> 24) || !IsBelievable(0));
}

bool LogReader::SeekTo(std::int64_t offset) {
  if (offset < 0 || offset > size_ || fseeko(file_, offset, SEEK_SET) != 0) return false;
  window_.clear();
  begin_ = 0;
  offset_ = offset;
  return true;
}

bool LogReader::Next(LogEvent& event) {
  while (offset_ < size_) {
    if (!IsBelievable(0)) {
      SkipDamage();
      continue;
    }
    const Lengths lengths = LengthsOf(At(0));
    const std::size_t total = lengths.total();
    if (!Have(total)) {  // The file became shorter while it was read.
      SkipDamage();
      continue;
    }
    const bool ends_the_file = offset_ + static_cast<std::int64_t>(total) == size_;
    if (!ends_the_file && !IsBelievable(total) && HidesAnEvent(total)) {
      SkipDamage();
      continue;
    }
    const std::uint8_t* p = At(0);
    event.number = Load<std::int64_t>(p + 4);
    event.received = FromMicros(Load<std::int64_t>(p + 12));
    event.channel.assign(reinterpret_cast<const char*>(p + kHeaderBytes), lengths.channel);
    event.bytes.assign(p + kHeaderBytes + lengths.channel, p + total);
    begin_ += total;
    offset_ += static_cast<std::int64_t>(total);
    return true;
  }
  return false;
}

}  // namespace v2vouch
