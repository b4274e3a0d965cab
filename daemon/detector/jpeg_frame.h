// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace v2vouch {

/// What a JPEG file says of itself, read without decoding it.
struct JpegFrame {
  int width_px = 0;
  int height_px = 0;
  int components = 0;  ///< 1 grey, 3 colour.
};

/// Walks the segments of a JPEG file (ITU-T T.81, annex B) and says what a decoder would make of
/// it, so that nothing is allocated for a picture that nobody wants.
///
/// @return nullopt for what is no whole picture: no SOI, a segment that runs past the end, no frame
///   header before the first scan, a lossless or arithmetic-coded or 12-bit frame (no decoder here
///   reads those), a size of 0, other than 1 or 3 components, more than 64 scans (a small file of
///   thousands of scans keeps a decoder busy for minutes), or an end without EOI: truncated.
std::optional<JpegFrame> ReadJpegFrame(std::span<const std::uint8_t> bytes);

}  // namespace v2vouch
