// SPDX-License-Identifier: Apache-2.0
#include "sim/import/csv.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>

namespace v2vouch::sim {
namespace {

// Longer lines are not data of the kinds read here.
constexpr std::size_t kMaxLine = 65536;

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) {
    text.remove_suffix(1);
  }
  return text;
}

void Split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(Trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

struct CsvReader::Stream {
  explicit Stream(const std::string& path) : file(gzopen(path.c_str(), "rb")) {}
  ~Stream() {
    if (file != nullptr) gzclose(file);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  gzFile file;
};

CsvReader::~CsvReader() = default;

std::unique_ptr<CsvReader> CsvReader::Open(const std::string& path,
                                           const std::vector<std::string>& columns,
                                           std::string& error) {
  std::unique_ptr<CsvReader> reader(new CsvReader());
  reader->path_ = path;
  reader->columns_ = columns;
  reader->stream_ = std::make_unique<Stream>(path);
  if (reader->stream_->file == nullptr) {
    error = path + ": cannot be opened: " + std::strerror(errno);
    return nullptr;
  }
  if (!reader->ReadLine()) {
    error = reader->error_.empty() ? path + ": is empty" : reader->error_;
    return nullptr;
  }
  std::vector<std::string_view> header;
  Split(reader->text_, header);
  reader->width_ = header.size();
  std::string missing;
  for (const std::string& column : columns) {
    const auto found = std::find(header.begin(), header.end(), column);
    if (found == header.end()) missing += (missing.empty() ? "" : ", ") + column;
    reader->positions_.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  if (!missing.empty()) {
    std::string seen = reader->text_.substr(0, 200);  // Whatever the file is: for a terminal.
    for (char& c : seen) c = static_cast<unsigned char>(c) - 0x20u < 0x5Fu ? c : '?';
    error = path + ": lacks the column(s) " + missing + "; its header is: " + seen;
    return nullptr;
  }
  return reader;
}

bool CsvReader::ReadLine() {
  text_.clear();
  char chunk[4096];
  while (gzgets(stream_->file, chunk, static_cast<int>(sizeof chunk)) != nullptr) {
    text_ += chunk;
    if (text_.size() > kMaxLine) {
      ++line_;
      Fail("line is too long");
      return false;
    }
    if (text_.back() == '\n') {
      text_.pop_back();
      break;
    }
  }
  int code = Z_OK;
  const char* message = gzerror(stream_->file, &code);
  // Z_BUF_ERROR: a compressed file that ends too early.
  if (code != Z_OK && code != Z_STREAM_END) {
    ++line_;
    Fail(std::string("cannot be read further: ") + message);
    return false;
  }
  if (text_.empty() && gzeof(stream_->file) != 0) return false;
  ++line_;
  return true;
}

bool CsvReader::Next() {
  std::vector<std::string_view> all;
  while (error_.empty() && ReadLine()) {
    if (Trimmed(text_).empty()) continue;
    Split(text_, all);
    if (all.size() != width_) {
      Fail("has " + std::to_string(all.size()) + " fields, the header " + std::to_string(width_));
      return false;
    }
    fields_.clear();
    for (const std::size_t position : positions_) fields_.push_back(all[position]);
    return true;
  }
  return false;
}

double CsvReader::Number(std::size_t column) {
  const std::string_view text = fields_[column];
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    Fail(columns_[column] + " = \"" + std::string(text.substr(0, 40)) + "\" is not a number");
    return 0.0;
  }
  return value;
}

void CsvReader::Fail(std::string_view why) {
  if (!error_.empty()) return;  // The first fault is the one that helps.
  error_ = path_ + ":" + std::to_string(line_) + ": " + std::string(why);
}

}  // namespace v2vouch::sim
