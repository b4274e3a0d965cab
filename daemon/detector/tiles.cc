// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/tiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace v2vouch {
namespace {

constexpr double kBorderShare = 0.01;
constexpr double kMostOfIt = 0.5;

struct Part {
  CameraBox box;
  std::size_t tile = 0;
  bool is_cut_left = false;
  bool is_cut_right = false;
  bool is_gone = false;
};

double Overlap(double a_from, double a_size, double b_from, double b_size) {
  return std::max(0.0, std::min(a_from + a_size, b_from + b_size) - std::max(a_from, b_from));
}

// Share of `part` that `other` covers.
double Covered(const CameraBox& part, const CameraBox& other) {
  return Overlap(part.left_px, part.width_px, other.left_px, other.width_px) *
         Overlap(part.top_px, part.height_px, other.top_px, other.height_px) /
         (part.width_px * part.height_px);
}

std::vector<Part> PartsOf(const std::vector<Tile>& tiles,
                          const std::vector<std::vector<CameraBox>>& boxes, int width_px) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const Tile& tile = tiles[i];
    const double near = kBorderShare * tile.width_px;
    const int right = tile.left_px + tile.width_px;
    for (const CameraBox& box : boxes[i]) {
      Part part{box, i};
      part.is_cut_left = tile.left_px > 0 && box.left_px < tile.left_px + near;
      part.is_cut_right = right < width_px && box.left_px + box.width_px > right - near;
      parts.push_back(part);
    }
  }
  return parts;
}

bool AreHalves(const Part& left, const Part& right) {
  if (!left.is_cut_right || !right.is_cut_left || right.tile != left.tile + 1) return false;
  const CameraBox& a = left.box;
  const CameraBox& b = right.box;
  return Overlap(a.left_px, a.width_px, b.left_px, b.width_px) > 0.0 &&
         Overlap(a.top_px, a.height_px, b.top_px, b.height_px) >
             kMostOfIt * std::min(a.height_px, b.height_px);
}

void Join(Part& left, Part& right) {
  CameraBox& a = left.box;
  const CameraBox& b = right.box;
  const double end = std::max(a.left_px + a.width_px, b.left_px + b.width_px);
  const double bottom = std::max(a.top_px + a.height_px, b.top_px + b.height_px);
  a.left_px = std::min(a.left_px, b.left_px);
  a.top_px = std::min(a.top_px, b.top_px);
  a.width_px = end - a.left_px;
  a.height_px = bottom - a.top_px;
  if (b.score > a.score) {
    a.score = b.score;
    a.object_class = b.object_class;
  }
  left.is_cut_right = right.is_cut_right;
  left.tile = right.tile;
  right.is_gone = true;
}

}  // namespace

std::vector<Tile> TilesOf(int width_px, int count, double overlap) {
  const double share = 1.0 / (count - (count - 1) * overlap);
  const int tile_px = std::clamp(static_cast<int>(std::ceil(share * width_px)), 1, width_px);
  std::vector<Tile> tiles;
  for (int i = 0; i < count; ++i) {
    const int left = count == 1 ? 0 : (width_px - tile_px) * i / (count - 1);
    tiles.push_back({left, tile_px});
  }
  return tiles;
}

std::vector<CameraBox> MergeTiles(const std::vector<Tile>& tiles,
                                  const std::vector<std::vector<CameraBox>>& boxes, int width_px) {
  std::vector<Part> parts = PartsOf(tiles, boxes, width_px);
  for (Part& part : parts) {
    if (!part.is_cut_left && !part.is_cut_right) continue;
    part.is_gone = std::any_of(parts.begin(), parts.end(), [&](const Part& other) {
      const bool is_whole = !other.is_cut_left && !other.is_cut_right;
      return is_whole && other.tile != part.tile && Covered(part.box, other.box) > kMostOfIt;
    });
  }
  for (Part& left : parts) {
    for (Part& right : parts) {
      if (!left.is_gone && !right.is_gone && AreHalves(left, right)) Join(left, right);
    }
  }
  std::vector<CameraBox> merged;
  for (const Part& part : parts) {
    if (!part.is_gone) merged.push_back(part.box);
  }
  return merged;
}

}  // namespace v2vouch
