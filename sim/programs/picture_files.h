// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace v2vouch::sim {

/// A numbered picture of a folder as KITTI names them (000012.png; 0000000012.png in the raw data;
/// .jpg too), as JPEG bytes of quality 90.
/// @return empty where there is none; with `error` set where it cannot be read or has another size
///   than `width_px` x `height_px`.
std::vector<std::uint8_t> NumberedPicture(const std::string& folder, int number, int width_px,
                                          int height_px, std::string& error);

/// The largest number of a picture in the folder; -1: none.
int LastNumberedPicture(const std::string& folder);

/// Size of a numbered picture. @return false where there is none that can be read.
bool SizeOfNumberedPicture(const std::string& folder, int number, int& width_px, int& height_px);

}  // namespace v2vouch::sim
