// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// A stretch of a picture over its whole height.
struct Tile {
  int left_px = 0;
  int width_px = 0;
};

/// `count` tiles of one width w side by side, each sharing `overlap` w with its neighbour, covering
/// the picture: w = width / (count - (count - 1) overlap), rounded up.
std::vector<Tile> TilesOf(int width_px, int count, double overlap);

/// One list from those of the tiles (`boxes[i]` seen in `tiles[i]`, pixels of the picture). A box
/// that ends at an inner border of its tile (within 1 % of the tile's width) is a part of a
/// vehicle: it goes where a box of another tile covers more than half of it, and becomes one with
/// its other half where two parts meet across neighbouring tiles and overlap by more than half of
/// the lesser height. What two tiles see whole is left to SuppressNonMaxima.
std::vector<CameraBox> MergeTiles(const std::vector<Tile>& tiles,
                                  const std::vector<std::vector<CameraBox>>& boxes, int width_px);

}  // namespace v2vouch
