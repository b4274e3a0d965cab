// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/common/data/input.h"
#include "daemon/programs/detect/detect_log.h"
#include "daemon/programs/detect/truth_boxes.h"

namespace v2vouch {

/// What the detector made of one picture file.
struct PictureReport {
  std::string image;
  double ms = 0.0;  ///< Wall time from pixels to boxes.
  std::vector<CameraBox> boxes;
};

/// [{"image":..,"ms":..,"boxes":[{"class":"car","score":..,"x":..,"y":..,"width":..,"height":..}]}]
/// with a score: {"pictures":[the same],"truths":..,"found":..,"false":..,"recall":..,
/// "precision":..,"ms_median":..}.
std::string JsonReport(const std::vector<PictureReport>& pictures,
                       const std::optional<FindScore>& score);
/// The same for people.
std::string TextReport(const std::vector<PictureReport>& pictures,
                       const std::optional<FindScore>& score);

/// Of a whole log: {"events":..,"pictures":..,"boxes":..,"refused":{"REASON":n}} or lines.
std::string LogReport(const DetectLogResult& result, bool as_json);

}  // namespace v2vouch
