// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/picture_files.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

namespace v2vouch::sim {
namespace {

namespace fs = std::filesystem;

constexpr int kQuality = 90;  // 1242 x 375 takes about 150 kB: one LCM message of the usual size.

// "" where the folder has no such number.
std::string PathOf(const std::string& folder, int number) {
  for (const char* pattern : {"%06d.png", "%010d.png", "%06d.jpg", "%010d.jpg"}) {
    char name[32];
    std::snprintf(name, sizeof(name), pattern, number);
    const fs::path path = fs::path(folder) / name;
    std::error_code failed;
    if (fs::is_regular_file(path, failed)) return path.string();
  }
  return "";
}

cv::Mat Read(const std::string& path) {
  try {
    return cv::imread(path, cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace

std::vector<std::uint8_t> NumberedPicture(const std::string& folder, int number, int width_px,
                                          int height_px, std::string& error) {
  const std::string path = PathOf(folder, number);
  if (path.empty()) return {};
  const cv::Mat picture = Read(path);
  std::vector<std::uint8_t> bytes;
  if (picture.cols != width_px || picture.rows != height_px) {
    error =
        path + ": is no picture of " + std::to_string(width_px) + " x " + std::to_string(height_px);
  } else if (!cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality})) {
    error = path + ": cannot be made a JPEG";
  }
  return bytes;
}

int LastNumberedPicture(const std::string& folder) {
  int last = -1;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().stem().string();
    int number = -1;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), number);
    const bool is_number = fault == std::errc() && end == name.data() + name.size();
    if (is_number && !PathOf(folder, number).empty()) last = std::max(last, number);
  }
  return last;
}

bool SizeOfNumberedPicture(const std::string& folder, int number, int& width_px, int& height_px) {
  const cv::Mat picture = Read(PathOf(folder, number));
  width_px = picture.cols;
  height_px = picture.rows;
  return !picture.empty();
}

}  // namespace v2vouch::sim
