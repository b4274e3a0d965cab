// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/truth_boxes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <optional>
#include <string_view>

#include "daemon/detector/yolo_boxes.h"

namespace v2vouch {
namespace {

constexpr double kLeastHeight_px = 25.0;  // KITTI's moderate and hard level.
constexpr double kLeastOverlap = 0.5;
constexpr int kMostOcclusion = 1;

constexpr std::array<std::string_view, 7> kColumns = {"image", "type",  "occluded", "left",
                                                      "top",   "right", "bottom"};

std::vector<std::string> FieldsOf(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back().push_back(c);
    }
  }
  return fields;
}

std::optional<double> Number(const std::string& text) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

ObjectClass ClassOfType(const std::string& type) {
  if (type == "Car") return ObjectClass::kCar;
  if (type == "Van") return ObjectClass::kVan;
  if (type == "Truck") return ObjectClass::kTruck;
  if (type == "Bus") return ObjectClass::kBus;
  return ObjectClass::kUnknown;
}

bool IsFourWheeled(ObjectClass c) {
  return c == ObjectClass::kCar || c == ObjectClass::kVan || c == ObjectClass::kTruck ||
         c == ObjectClass::kBus;
}

bool IsMostlyInside(const CameraBox& box, const CameraBox& region) {
  const double width = std::min(box.left_px + box.width_px, region.left_px + region.width_px) -
                       std::max(box.left_px, region.left_px);
  const double height = std::min(box.top_px + box.height_px, region.top_px + region.height_px) -
                        std::max(box.top_px, region.top_px);
  return width > 0.0 && height > 0.0 &&
         width * height > kLeastOverlap * box.width_px * box.height_px;
}

}  // namespace

bool ReadTruth(const std::string& path, TruthTable& truth, std::string& error) {
  std::ifstream file(path);
  if (!file) {
    error = path + ": cannot be read";
    return false;
  }
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> header = FieldsOf(line);
  std::array<std::size_t, kColumns.size()> at{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    at[i] = static_cast<std::size_t>(std::find(header.begin(), header.end(), kColumns[i]) -
                                     header.begin());
    if (at[i] == header.size()) {
      error = path + ":1: no column " + std::string(kColumns[i]);
      return false;
    }
  }
  for (int number = 2; std::getline(file, line); ++number) {
    if (line.empty()) continue;
    const std::vector<std::string> fields = FieldsOf(line);
    std::array<double, 5> values{};  // occluded, left, top, right, bottom.
    bool is_good = fields.size() == header.size();
    for (std::size_t i = 0; is_good && i < values.size(); ++i) {
      const auto value = Number(fields[at[i + 2]]);
      is_good = value.has_value();
      values[i] = value.value_or(0.0);
    }
    if (!is_good || values[3] < values[1] || values[4] < values[2]) {
      error = path + ":" + std::to_string(number) + ": is no labelled box";
      return false;
    }
    TruthBox box;
    box.box = {values[1],
               values[2],
               values[3] - values[1],
               values[4] - values[2],
               ClassOfType(fields[at[1]]),
               1.0};
    box.counts = IsFourWheeled(box.box.object_class) && box.box.height_px >= kLeastHeight_px &&
                 values[0] >= 0.0 && values[0] <= kMostOcclusion;
    truth[fields[at[0]]].push_back(box);
  }
  return true;
}

void AddScore(const std::vector<CameraBox>& boxes, const std::vector<TruthBox>& truths,
              FindScore& score) {
  std::vector<bool> is_taken(truths.size(), false);
  score.truths += static_cast<int>(
      std::count_if(truths.begin(), truths.end(), [](const TruthBox& t) { return t.counts; }));
  for (const CameraBox& box : boxes) {
    if (!IsFourWheeled(box.object_class)) continue;
    std::optional<std::size_t> best;
    double best_overlap = kLeastOverlap;
    bool is_ignored = box.height_px < kLeastHeight_px;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      if (truths[i].box.object_class == ObjectClass::kUnknown) {
        is_ignored = is_ignored || IsMostlyInside(box, truths[i].box);
        continue;
      }
      const double overlap = IntersectionOverUnion(box, truths[i].box);
      // Where both fit, one that counts goes first.
      if (is_taken[i] || overlap < kLeastOverlap) continue;
      const bool is_better = !best || truths[i].counts > truths[*best].counts ||
                             (truths[i].counts == truths[*best].counts && overlap > best_overlap);
      if (is_better) {
        best = i;
        best_overlap = overlap;
      }
    }
    if (best) {
      is_taken[*best] = true;
      if (truths[*best].counts) ++score.found;
    } else if (!is_ignored) {
      ++score.false_boxes;
    }
  }
}

}  // namespace v2vouch
