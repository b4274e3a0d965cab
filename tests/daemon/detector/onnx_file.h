// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace v2vouch {

/// Bytes of an ONNX model (protobuf, opset 11) with the outputs of a YOLOX network of two classes:
/// [1, cells, 7] over the grids of stride 8, 16 and 32. Each cell averages its part of the picture
/// (0..255); objectness is a third of the sum of the channels over 255, so that white cells see an
/// object of class 1, one stride wide, in their middle.
std::string TinyYolox(int width_px, int height_px);

}  // namespace v2vouch
