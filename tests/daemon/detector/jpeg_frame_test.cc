// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/jpeg_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace v2vouch {
namespace {

using Bytes = std::vector<std::uint8_t>;

// A real encoder's file: baseline or progressive, grey or colour.
Bytes Jpeg(int width, int height, int type, bool is_progressive) {
  cv::Mat picture(height, width, type);
  cv::randu(picture, 0, 255);
  Bytes bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, is_progressive ? 1 : 0});
  return bytes;
}

// Where the two bytes FF `marker` stand first.
std::size_t Find(const Bytes& bytes, std::uint8_t marker) {
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    if (bytes[i] == 0xFF && bytes[i + 1] == marker) return i;
  }
  return bytes.size();
}

TEST(JpegFrame, SizeAndColoursOfWholeFiles) {
  for (const bool is_progressive : {false, true}) {
    const auto colour = ReadJpegFrame(Jpeg(37, 21, CV_8UC3, is_progressive));
    ASSERT_TRUE(colour);
    EXPECT_EQ(colour->width_px, 37);
    EXPECT_EQ(colour->height_px, 21);
    EXPECT_EQ(colour->components, 3);
    EXPECT_EQ(ReadJpegFrame(Jpeg(8, 8, CV_8UC1, is_progressive))->components, 1);
  }
}

TEST(JpegFrame, NoBeginningOfAFileIsAPicture) {
  const Bytes whole = Jpeg(32, 32, CV_8UC3, true);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(ReadJpegFrame(std::span(whole).first(length))) << length << " bytes";
  }
}

TEST(JpegFrame, OtherFilesAreNone) {
  Bytes png;
  cv::imencode(".png", cv::Mat(8, 8, CV_8UC3), png);
  EXPECT_FALSE(ReadJpegFrame(png));
  EXPECT_FALSE(ReadJpegFrame(Bytes(100, 0xFF)));
  EXPECT_FALSE(ReadJpegFrame(Bytes{0xFF, 0xD8, 0xFF, 0xD9}));  // Neither frame nor scan.
}

TEST(JpegFrame, FramesThatNoDecoderHereReads) {
  const Bytes good = Jpeg(16, 16, CV_8UC3, false);
  const std::size_t frame = Find(good, 0xC0);
  const auto changed = [&](std::size_t offset, std::uint8_t value) {
    Bytes bytes = good;
    bytes[frame + offset] = value;
    return ReadJpegFrame(bytes).has_value();
  };
  EXPECT_TRUE(changed(1, 0xC1));   // Extended sequential.
  EXPECT_FALSE(changed(1, 0xC3));  // Lossless.
  EXPECT_FALSE(changed(1, 0xC9));  // Arithmetic coding.
  EXPECT_FALSE(changed(4, 12));    // 12 bits a sample.
  EXPECT_FALSE(changed(6, 0));     // Height 0.
  EXPECT_FALSE(changed(9, 4));     // Four colours.
  EXPECT_FALSE(changed(2, 0xFF));  // A segment longer than the file.
}

// A small file of many scans keeps a decoder busy for minutes.
TEST(JpegFrame, ScansWithoutEndAreRefused) {
  Bytes bytes = Jpeg(16, 16, CV_8UC3, true);
  const std::size_t scan = Find(bytes, 0xDA);
  const Bytes again(bytes.begin() + static_cast<std::ptrdiff_t>(scan), bytes.end() - 2);
  bytes.erase(bytes.end() - 2, bytes.end());
  for (int i = 0; i < 100; ++i) bytes.insert(bytes.end(), again.begin(), again.end());
  bytes.insert(bytes.end(), {0xFF, 0xD9});
  EXPECT_FALSE(ReadJpegFrame(bytes));
}

}  // namespace
}  // namespace v2vouch
