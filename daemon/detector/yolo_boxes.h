// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "daemon/common/data/detector_config.h"
#include "daemon/common/data/input.h"

namespace v2vouch {

/// Rows that a YOLO network gives: box, objectness, one score per class.
struct YoloRows {
  std::span<const float> values;  ///< A whole number of rows.
  int columns = 0;                ///< 5 + number of classes; at least 6.
};

/// Size of the network's input. Boxes come out in its pixels.
struct InputSize {
  int width_px = 0;
  int height_px = 0;
};

/// Rows of darknet's [yolo] layers as OpenCV gives them: centre and size as shares of the input,
/// class scores already multiplied by objectness. (OpenCV sets scores under 0.2 to 0.)
///
/// The class of a row is its best one among all that the network knows; rows whose class is not in
/// `config.classes`, whose score is under `config.min_score`, or with values that are not finite
/// are left out. Boxes are added to `boxes`.
void AddDarknetBoxes(const YoloRows& rows, InputSize input, const DetectorConfig& config,
                     std::vector<CameraBox>& boxes);

/// Rows of YOLOX as exported to ONNX without decoding (Ge et al. 2021): the grids of stride 8, 16
/// and 32 behind each other, row by row,
///
///     centre = (offset + cell) stride,  size = exp(value) stride,  score = objectness class score
///
/// @return false, with nothing added, where the number of rows is not that of those grids.
bool AddYoloxBoxes(const YoloRows& rows, InputSize input, const DetectorConfig& config,
                   std::vector<CameraBox>& boxes);

/// Of every two boxes that overlap by more than `iou` (intersection over union) the weaker one
/// goes. Cars, vans, lorries and buses compete with each other, since a network often gives one
/// vehicle two names; every other class competes within itself. Strongest first afterwards; equal
/// scores keep their order.
void SuppressNonMaxima(double iou, std::vector<CameraBox>& boxes);

/// Intersection over union, 0..1.
double IntersectionOverUnion(const CameraBox& a, const CameraBox& b);

}  // namespace v2vouch
