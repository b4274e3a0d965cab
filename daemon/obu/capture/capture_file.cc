// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/capture/capture_file.h"

#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "daemon/obu/octets/hex_text.h"

namespace v2vouch::obu {
namespace {

struct ClosePcap {
  void operator()(pcap_t* capture) const { pcap_close(capture); }
};

class PcapFile final : public CaptureFile {
 public:
  explicit PcapFile(pcap_t* capture) : capture_(capture), link_type_(pcap_datalink(capture)) {}

  std::optional<Captured> Next(std::string& error) override {
    pcap_pkthdr* header = nullptr;
    const unsigned char* bytes = nullptr;
    const int got = pcap_next_ex(capture_.get(), &header, &bytes);
    if (got != 1) {
      if (got == PCAP_ERROR) error = pcap_geterr(capture_.get());
      return std::nullopt;
    }
    Captured captured;
    captured.utime = static_cast<std::int64_t>(header->ts.tv_sec) * 1000000 + header->ts.tv_usec;
    captured.link_type = link_type_;
    captured.bytes = Bytes(bytes, header->caplen);
    captured.is_cut = header->caplen < header->len;
    return captured;
  }

 private:
  std::unique_ptr<pcap_t, ClosePcap> capture_;
  int link_type_;
};

// One datagram a line; blanks round it, empty lines and comments behind '#' are passed over.
class HexFile final : public CaptureFile {
 public:
  HexFile(const std::string& path, bool join_lines)
      : file_(path, std::ios::binary), join_lines_(join_lines) {}

  std::optional<Captured> Next(std::string&) override {
    Captured captured;
    std::string joined;
    while (ReadLine()) {
      const std::string_view text = std::string_view(line_).substr(0, line_.find('#'));
      if (text.find_first_not_of(" \t\r\f\v") == std::string_view::npos) continue;
      if (join_lines_) {
        if (joined.size() < kLongestLine) joined.append(text).push_back('\n');
        continue;
      }
      captured.line = number_;
      captured.fault = ReadHex(text, scratch_, captured.bytes);
      return captured;
    }
    if (joined.empty()) return std::nullopt;
    captured.line = 1;
    captured.fault = ReadHex(joined, scratch_, captured.bytes);
    return captured;
  }

 private:
  static constexpr std::size_t kLongestLine = 65536;

  // What is beyond the longest line is dropped: no line takes memory without end.
  bool ReadLine() {
    line_.clear();
    bool has_line = false;
    for (int letter = file_.get(); letter != std::ifstream::traits_type::eof();
         letter = file_.get()) {
      has_line = true;
      if (letter == '\n') break;
      if (line_.size() < kLongestLine) line_.push_back(static_cast<char>(letter));
    }
    number_ += has_line ? 1 : 0;
    if (number_ == 1 && line_.starts_with("\xEF\xBB\xBF")) line_.erase(0, 3);  // Byte order mark.
    return has_line;
  }

  std::ifstream file_;
  bool join_lines_;
  std::string line_;
  std::int64_t number_ = 0;
  std::array<std::uint8_t, kLongestDatagram> scratch_{};
};

// The whole file is one datagram.
class RawFile final : public CaptureFile {
 public:
  explicit RawFile(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {}
  std::optional<Captured> Next(std::string&) override {
    if (is_done_) return std::nullopt;
    is_done_ = true;
    Captured captured;
    captured.bytes = bytes_;
    return captured;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  bool is_done_ = false;
};

bool IsCapture(Bytes head) {
  ByteReader reader(head);
  const auto magic = static_cast<std::uint32_t>(reader.Big(4, ""));
  // pcap in either byte order, with microseconds, with nanoseconds, "modified"; pcapng.
  for (const std::uint32_t known : {0xA1B2C3D4U, 0xD4C3B2A1U, 0xA1B23C4DU, 0x4D3CB2A1U, 0xA1B2CD34U,
                                    0x34CDB2A1U, 0x0A0D0D0AU}) {
    if (reader.ok() && magic == known) return true;
  }
  return false;
}

bool IsText(Bytes bytes) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) {
    return byte >= 0x20 ? byte != 0x7F : byte == '\t' || byte == '\n' || byte == '\r';
  });
}

}  // namespace

std::unique_ptr<CaptureFile> CaptureFile::Open(const std::string& path, bool join_lines,
                                               std::string& error) {
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed)) {
    error = path + ": is a folder";
    return nullptr;
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    error = path + ": " + std::strerror(errno);
    return nullptr;
  }
  std::vector<std::uint8_t> head(kLongestDatagram + 1);
  file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  if (head.empty()) {
    error = path + ": is empty";
    return nullptr;
  }
  if (IsCapture(head)) {
    char text[PCAP_ERRBUF_SIZE] = "";
    pcap_t* const capture = pcap_open_offline(path.c_str(), text);
    if (capture != nullptr) return std::make_unique<PcapFile>(capture);
    error = path + ": " + text;
    return nullptr;
  }
  if (path.ends_with(".hex") || IsText(head)) return std::make_unique<HexFile>(path, join_lines);
  if (head.size() <= kLongestDatagram) return std::make_unique<RawFile>(std::move(head));
  error = path + ": neither a capture (pcap, pcapng) nor hex text, and too long for one datagram";
  return nullptr;
}

}  // namespace v2vouch::obu
