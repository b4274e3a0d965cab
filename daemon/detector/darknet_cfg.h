// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace v2vouch {

/// Bytes that the .weights file of a darknet .cfg must have: a header of 20, then 4 for every
/// parameter of the convolutions in order,
///
///     filters (channels / groups) size^2 + filters (4 with batch normalisation, else 1)
///
/// OpenCV reads a file that is too short without a word and computes with what was in memory.
/// @param text content of the .cfg.
/// @return nullopt where it cannot be said: no darknet network, or layers other than convolutional,
///   maxpool, upsample, route, shortcut, dropout and yolo.
std::optional<std::int64_t> DarknetWeightBytes(std::string_view text);

}  // namespace v2vouch
