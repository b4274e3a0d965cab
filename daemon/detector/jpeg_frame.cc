// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/jpeg_frame.h"

#include <cstddef>

namespace v2vouch {
namespace {

constexpr std::uint8_t kStartOfImage = 0xD8;
constexpr std::uint8_t kEndOfImage = 0xD9;
constexpr std::uint8_t kStartOfScan = 0xDA;
constexpr int kMaxScans = 64;

bool IsRestart(std::uint8_t marker) { return marker >= 0xD0 && marker <= 0xD7; }

// SOF0..SOF15 without DHT (C4), JPG (C8) and DAC (CC).
bool IsFrame(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

// Baseline, extended sequential and progressive, all Huffman-coded.
bool IsReadableFrame(std::uint8_t marker) { return marker >= 0xC0 && marker <= 0xC2; }

class Walk {
 public:
  explicit Walk(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  // The next marker; any fill bytes (FF) before it are skipped.
  std::optional<std::uint8_t> Marker() {
    if (at_ >= bytes_.size() || bytes_[at_] != 0xFF) return std::nullopt;
    while (at_ < bytes_.size() && bytes_[at_] == 0xFF) ++at_;
    if (at_ >= bytes_.size()) return std::nullopt;
    return bytes_[at_++];
  }

  // The segment behind a marker, its two length bytes left out.
  std::optional<std::span<const std::uint8_t>> Segment() {
    if (bytes_.size() - at_ < 2) return std::nullopt;
    const std::size_t length = Word(bytes_.subspan(at_));
    if (length < 2 || length > bytes_.size() - at_) return std::nullopt;
    const auto segment = bytes_.subspan(at_ + 2, length - 2);
    at_ += length;
    return segment;
  }

  // Over entropy-coded data to the marker that ends it.
  void SkipScan() {
    for (; at_ + 1 < bytes_.size(); ++at_) {
      if (bytes_[at_] == 0xFF && bytes_[at_ + 1] != 0 && !IsRestart(bytes_[at_ + 1])) return;
    }
    at_ = bytes_.size();
  }

  static std::size_t Word(std::span<const std::uint8_t> two) {
    return static_cast<std::size_t>(two[0]) << 8U | two[1];
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

std::optional<JpegFrame> ParseFrame(std::span<const std::uint8_t> segment) {
  if (segment.size() < 6 || segment[0] != 8) return std::nullopt;
  JpegFrame frame;
  frame.height_px = static_cast<int>(Walk::Word(segment.subspan(1)));
  frame.width_px = static_cast<int>(Walk::Word(segment.subspan(3)));
  frame.components = segment[5];
  if (frame.width_px == 0 || frame.height_px == 0) return std::nullopt;
  if (frame.components != 1 && frame.components != 3) return std::nullopt;
  return frame;
}

}  // namespace

std::optional<JpegFrame> ReadJpegFrame(std::span<const std::uint8_t> bytes) {
  Walk walk(bytes);
  if (walk.Marker() != kStartOfImage) return std::nullopt;
  std::optional<JpegFrame> frame;
  int scans = 0;
  while (const auto marker = walk.Marker()) {
    if (*marker == kEndOfImage) return scans > 0 ? frame : std::nullopt;
    if (*marker == kStartOfImage || IsRestart(*marker)) return std::nullopt;
    const auto segment = walk.Segment();
    if (!segment) return std::nullopt;
    if (IsFrame(*marker)) {
      if (frame || !IsReadableFrame(*marker)) return std::nullopt;
      frame = ParseFrame(*segment);
      if (!frame) return std::nullopt;
    } else if (*marker == kStartOfScan) {
      if (!frame || ++scans > kMaxScans) return std::nullopt;
      walk.SkipScan();
    }
  }
  return std::nullopt;  // No EOI.
}

}  // namespace v2vouch
