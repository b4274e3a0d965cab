// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/detect_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "daemon/common/data/object_class.h"

namespace v2vouch {
namespace {

using Json = nlohmann::ordered_json;

// Tenths of a pixel, thousandths of a score: what is meant, and no more digits.
double Rounded(double value, double per_unit) { return std::round(value * per_unit) / per_unit; }

Json ToJson(const CameraBox& box) {
  return {{"class", std::string(ObjectClassName(box.object_class))},
          {"score", Rounded(box.score, 1e3)},
          {"x", Rounded(box.left_px, 10.0)},
          {"y", Rounded(box.top_px, 10.0)},
          {"width", Rounded(box.width_px, 10.0)},
          {"height", Rounded(box.height_px, 10.0)}};
}

double MedianMs(const std::vector<PictureReport>& pictures) {
  std::vector<double> all;
  for (const PictureReport& picture : pictures) all.push_back(picture.ms);
  if (all.empty()) return NAN;
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

std::string OrNone(const char* format, double value) {
  if (!std::isfinite(value)) return "none";
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

std::string Text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string JsonReport(const std::vector<PictureReport>& pictures,
                       const std::optional<FindScore>& score) {
  Json list = Json::array();
  for (const PictureReport& picture : pictures) {
    Json boxes = Json::array();
    for (const CameraBox& box : picture.boxes) boxes.push_back(ToJson(box));
    list.push_back({{"image", picture.image}, {"ms", Rounded(picture.ms, 10.0)}, {"boxes", boxes}});
  }
  if (!score) return Text(list);
  return Text({{"pictures", list},
               {"truths", score->truths},
               {"found", score->found},
               {"false", score->false_boxes},
               {"recall", Rounded(score->recall(), 1e3)},
               {"precision", Rounded(score->precision(), 1e3)},
               {"ms_median", Rounded(MedianMs(pictures), 10.0)}});
}

std::string TextReport(const std::vector<PictureReport>& pictures,
                       const std::optional<FindScore>& score) {
  std::string text;
  char line[256];
  for (const PictureReport& picture : pictures) {
    std::snprintf(line, sizeof(line), "  %zu boxes, %.0f ms\n", picture.boxes.size(), picture.ms);
    text += picture.image + line;
    for (const CameraBox& box : picture.boxes) {
      std::snprintf(line, sizeof(line), "  %-10s %.2f  %7.1f %7.1f  %6.1f x %.1f\n",
                    std::string(ObjectClassName(box.object_class)).c_str(), box.score, box.left_px,
                    box.top_px, box.width_px, box.height_px);
      text += line;
    }
  }
  if (!score) return text;
  std::snprintf(line, sizeof(line), "vehicles %d, found %d, false %d: recall ", score->truths,
                score->found, score->false_boxes);
  return text + line + OrNone("%.2f", score->recall()) + ", precision " +
         OrNone("%.2f", score->precision()) + "; median " + OrNone("%.0f ms", MedianMs(pictures)) +
         "\n";
}

std::string LogReport(const DetectLogResult& result, bool as_json) {
  Json refused = Json::object();
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    if (result.refused[i] == 0) continue;
    refused[std::string(ReasonName(static_cast<Reason>(i)))] = result.refused[i];
  }
  const Json report = {{"events", result.events},
                       {"pictures", result.pictures},
                       {"boxes", result.boxes},
                       {"refused", refused}};
  if (as_json) return Text(report);
  std::string text;
  for (const auto& [key, value] : report.items()) {
    text += key + std::string(10 - key.size(), ' ') + value.dump() + "\n";
  }
  return text;
}

}  // namespace v2vouch
