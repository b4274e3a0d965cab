// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/yolo_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace v2vouch {
namespace {

constexpr std::size_t kBoxColumns = 5;
constexpr std::array kYoloxStrides = {8, 16, 32};

struct Choice {
  ObjectClass object_class;
  double score;
};

// The best class of a row, where we want it and it is strong enough.
std::optional<Choice> Choose(std::span<const float> row, double objectness,
                             const DetectorConfig& config) {
  const auto scores = row.subspan(kBoxColumns);
  const auto best = std::max_element(scores.begin(), scores.end());
  const double score = objectness * static_cast<double>(*best);
  if (!(score >= config.min_score)) return std::nullopt;
  const auto id = best - scores.begin();
  const auto known = std::find_if(config.classes.begin(), config.classes.end(),
                                  [&](const NetworkClass& c) { return c.id == id; });
  if (known == config.classes.end()) return std::nullopt;
  return Choice{known->object_class, std::min(score, 1.0)};
}

void AddBox(double centre_x, double centre_y, double width, double height, const Choice& choice,
            std::vector<CameraBox>& boxes) {
  if (!(std::isfinite(centre_x) && std::isfinite(centre_y) && std::isfinite(width) &&
        std::isfinite(height) && width > 0.0 && height > 0.0)) {
    return;
  }
  boxes.push_back({centre_x - 0.5 * width, centre_y - 0.5 * height, width, height,
                   choice.object_class, choice.score});
}

std::size_t CountOf(const YoloRows& rows) {
  return rows.columns <= static_cast<int>(kBoxColumns)
             ? 0
             : rows.values.size() / static_cast<std::size_t>(rows.columns);
}

std::span<const float> RowOf(const YoloRows& rows, std::size_t index) {
  const auto columns = static_cast<std::size_t>(rows.columns);
  return rows.values.subspan(index * columns, columns);
}

// Classes that one vehicle may be given at once.
bool IsFourWheeled(ObjectClass c) {
  return c == ObjectClass::kCar || c == ObjectClass::kVan || c == ObjectClass::kTruck ||
         c == ObjectClass::kBus;
}

bool Compete(const CameraBox& a, const CameraBox& b) {
  return a.object_class == b.object_class ||
         (IsFourWheeled(a.object_class) && IsFourWheeled(b.object_class));
}

}  // namespace

void AddDarknetBoxes(const YoloRows& rows, InputSize input, const DetectorConfig& config,
                     std::vector<CameraBox>& boxes) {
  for (std::size_t i = 0; i < CountOf(rows); ++i) {
    const auto row = RowOf(rows, i);
    const auto choice = Choose(row, 1.0, config);
    if (!choice) continue;
    const double width = input.width_px;
    const double height = input.height_px;
    AddBox(static_cast<double>(row[0]) * width, static_cast<double>(row[1]) * height,
           static_cast<double>(row[2]) * width, static_cast<double>(row[3]) * height, *choice,
           boxes);
  }
}

bool AddYoloxBoxes(const YoloRows& rows, InputSize input, const DetectorConfig& config,
                   std::vector<CameraBox>& boxes) {
  std::size_t expected = 0;
  for (const int stride : kYoloxStrides) {
    expected += static_cast<std::size_t>(input.width_px / stride) *
                static_cast<std::size_t>(input.height_px / stride);
  }
  if (CountOf(rows) != expected) return false;
  std::size_t i = 0;
  for (const int stride : kYoloxStrides) {
    for (int y = 0; y < input.height_px / stride; ++y) {
      for (int x = 0; x < input.width_px / stride; ++x, ++i) {
        const auto row = RowOf(rows, i);
        const auto choice = Choose(row, static_cast<double>(row[4]), config);
        if (!choice) continue;
        AddBox((static_cast<double>(row[0]) + x) * stride,
               (static_cast<double>(row[1]) + y) * stride,
               std::exp(static_cast<double>(row[2])) * stride,
               std::exp(static_cast<double>(row[3])) * stride, *choice, boxes);
      }
    }
  }
  return true;
}

double IntersectionOverUnion(const CameraBox& a, const CameraBox& b) {
  const double width =
      std::min(a.left_px + a.width_px, b.left_px + b.width_px) - std::max(a.left_px, b.left_px);
  const double height =
      std::min(a.top_px + a.height_px, b.top_px + b.height_px) - std::max(a.top_px, b.top_px);
  if (width <= 0.0 || height <= 0.0) return 0.0;
  const double both = width * height;
  return both / (a.width_px * a.height_px + b.width_px * b.height_px - both);
}

void SuppressNonMaxima(double iou, std::vector<CameraBox>& boxes) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const CameraBox& a, const CameraBox& b) { return a.score > b.score; });
  std::vector<CameraBox> kept;
  for (const CameraBox& box : boxes) {
    const bool is_beaten = std::any_of(kept.begin(), kept.end(), [&](const CameraBox& stronger) {
      return Compete(box, stronger) && IntersectionOverUnion(box, stronger) > iou;
    });
    if (!is_beaten) kept.push_back(box);
  }
  boxes = std::move(kept);
}

}  // namespace v2vouch
