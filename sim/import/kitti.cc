// SPDX-License-Identifier: Apache-2.0
#include "sim/import/kitti.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

namespace v2vouch::sim {
namespace {

constexpr int kMaxFrame = 1'000'000;

std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

bool ReadNumber(std::string_view word, double& value) {
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  return fault == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

// Hands the words of every line that has any to `take`, which says what is wrong with them or "".
template <class Take>
bool ForEachLine(const std::string& path, std::string& error, const Take& take) {
  std::ifstream file(path);
  if (!file) {
    error = path + ": cannot be read";
    return false;
  }
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const auto words = Words(line);
    const std::string problem = words.empty() ? "" : take(words);
    if (problem.empty()) continue;
    error = path + ":" + std::to_string(number) + ": " + problem;
    return false;
  }
  return true;
}

// Columns 0 (frame), 1 (track), 3.. of a label.
bool ParseLabel(const std::vector<std::string_view>& words, KittiLabel& label) {
  double frame = 0.0;
  double track = 0.0;
  double occluded = 0.0;
  double alpha = 0.0;
  double* const slots[] = {
      &label.truncated, &occluded,        &alpha,          &label.left_px,       &label.top_px,
      &label.right_px,  &label.bottom_px, &label.height_m, &label.width_m,       &label.length_m,
      &label.x_m,       &label.y_m,       &label.z_m,      &label.rotation_y_rad};
  if (!ReadNumber(words[0], frame) || !ReadNumber(words[1], track)) return false;
  for (std::size_t i = 0; i < std::size(slots); ++i) {
    if (!ReadNumber(words[i + 3], *slots[i])) return false;
  }
  if (frame < 0.0 || frame > kMaxFrame || track < -1.0 || track > kMaxFrame || occluded < -1.0 ||
      occluded > 3.0) {
    return false;
  }
  label.frame = static_cast<int>(frame);
  label.track = static_cast<int>(track);
  label.occluded = static_cast<int>(occluded);
  label.type = words[2];
  return label.right_px >= label.left_px && label.bottom_px >= label.top_px;
}

}  // namespace

bool ReadKittiLabels(const std::string& path, std::vector<KittiLabel>& labels, std::string& error,
                     bool with_regions) {
  const auto take = [&](const std::vector<std::string_view>& words) -> std::string {
    if (words.size() != 17 && words.size() != 18) {
      return "has " + std::to_string(words.size()) + " columns; a tracking label has 17";
    }
    const bool is_region = words[2] == "DontCare";
    if (is_region && !with_regions) return "";
    KittiLabel label;
    if (!ParseLabel(words, label)) return "is no label";
    const bool is_solid = label.height_m > 0.0 && label.width_m > 0.0 && label.length_m > 0.0;
    if (!is_solid && !is_region) return "an object without size";
    labels.push_back(std::move(label));
    return "";
  };
  if (!ForEachLine(path, error, take)) return false;
  if (labels.empty()) error = path + ": holds no labelled object";
  return !labels.empty();
}

bool ReadKittiCamera(const std::string& path, KittiCamera& camera, std::string& error) {
  bool is_found = false;
  const auto take = [&](const std::vector<std::string_view>& words) -> std::string {
    if (is_found || (words[0] != "P2:" && words[0] != "P2")) return "";
    double values[12] = {};
    bool is_good = words.size() == 13;
    for (std::size_t i = 0; is_good && i < 12; ++i) is_good = ReadNumber(words[i + 1], values[i]);
    if (!is_good || values[0] <= 1.0 || values[5] <= 1.0) return "P2 is no projection of 3 x 4";
    camera = {values[0], values[5], values[2], values[6], values[3] / values[0]};
    is_found = true;
    return "";
  };
  if (!ForEachLine(path, error, take)) return false;
  if (!is_found) error = path + ": has no line P2:";
  return is_found;
}

bool ReadKittiOxts(const std::string& path, std::vector<KittiMotion>& motion, std::string& error) {
  constexpr std::size_t kForwardVelocity = 8;  // Columns of the development kit's readme.
  constexpr std::size_t kTurnAboutUp = 22;
  const auto take = [&](const std::vector<std::string_view>& words) -> std::string {
    KittiMotion now;
    now.is_measured = true;
    if (words.size() < 25 || !ReadNumber(words[kForwardVelocity], now.speed_mps) ||
        !ReadNumber(words[kTurnAboutUp], now.yaw_rate_radps) || std::abs(now.speed_mps) > 100.0 ||
        std::abs(now.yaw_rate_radps) > 5.0) {
      return "is no line of oxts";
    }
    motion.push_back(now);
    return "";
  };
  if (!ForEachLine(path, error, take)) return false;
  if (motion.empty()) error = path + ": is empty";
  return !motion.empty();
}

}  // namespace v2vouch::sim
