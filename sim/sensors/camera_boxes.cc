// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/camera_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace v2vouch::sim {
namespace {

ObjectClass Confused(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
      return ObjectClass::kVan;
    case ObjectClass::kVan:
      return ObjectClass::kCar;
    case ObjectClass::kTruck:
      return ObjectClass::kBus;
    case ObjectClass::kBus:
      return ObjectClass::kTruck;
    case ObjectClass::kMotorcycle:
      return ObjectClass::kCyclist;
    case ObjectClass::kCyclist:
      return ObjectClass::kMotorcycle;
    default:
      return object_class;
  }
}

}  // namespace

void PixelBox::Add(const Eigen::Vector2d& pixel) {
  left = std::min(left, pixel.x());
  right = std::max(right, pixel.x());
  top = std::min(top, pixel.y());
  bottom = std::max(bottom, pixel.y());
  is_empty = false;
}

void SetClass(ObjectClass object_class, camera_box_t& box) {
  box.class_id = static_cast<std::int32_t>(object_class);
  box.class_name = ObjectClassName(object_class);
}

std::optional<camera_box_t> VehicleBox(const CameraConfig& camera, double sigma_px,
                                       const PixelBox& seen, double visible_fraction,
                                       ObjectClass object_class, Random& random) {
  const double width = camera.image_width_px;
  const double height = camera.image_height_px;
  camera_box_t box{};
  const auto edge = [&](double exact, double low, double high) {
    const double noise = random.Normal(0.0, sigma_px);  // Drawn always: order stays fixed.
    if (exact <= low) return low;
    if (exact >= high) return high;
    return std::clamp(exact + noise, low, high);
  };
  box.left_px = edge(seen.left, 0.0, width);
  box.top_px = edge(seen.top, 0.0, height);
  box.width_px = edge(seen.right, 0.0, width) - box.left_px;
  box.height_px = edge(seen.bottom, 0.0, height) - box.top_px;
  const double size = std::clamp(box.height_px / 60.0, 0.0, 1.0);
  box.score = std::clamp(0.5 + 0.25 * size + 0.2 * visible_fraction + random.Normal(0.0, 0.05),
                         std::min(0.99, camera.min_score + 0.02), 0.99);
  if (random.Bernoulli(0.03 + 0.07 * (1.0 - size))) object_class = Confused(object_class);
  if (box.width_px < 3.0 || box.height_px < 4.0) return std::nullopt;
  SetClass(object_class, box);
  return box;
}

camera_box_t ClutterBox(const CameraConfig& camera, Random& random) {
  const double width = camera.image_width_px;
  const double height = camera.image_height_px;
  camera_box_t box{};
  box.height_px = random.Uniform(12.0, 0.12 * height);
  box.width_px = box.height_px * random.Uniform(0.8, 2.0);
  box.left_px = random.Uniform(0.0, width - box.width_px);
  box.top_px =
      std::clamp(camera.cy_px + random.Uniform(-0.05, 0.1) * height, 0.0, height - box.height_px);
  box.score = std::min(0.99, camera.min_score + random.Uniform(0.0, 0.3));
  SetClass(ObjectClass::kCar, box);
  return box;
}

void AddFamilyBoxes(const CameraConfig& camera, const CameraFamilySpec& spec, double noise_scale,
                    const PixelBox& exact, const CameraFamily::Vehicle& vehicle,
                    ObjectClass object_class, Random& random, camera_detections_t& picture) {
  const double size_px = std::max(exact.right - exact.left, exact.bottom - exact.top);
  const double slow_px = std::hypot(spec.edge_markov_px, spec.edge_markov_share * size_px);
  const auto add = [&](const std::array<double, 4>& edges) {
    std::array<double, 4> noisy = edges;
    for (std::size_t k = 0; k < 4; ++k) {
      const double far = k % 2 == 0 ? camera.image_width_px : camera.image_height_px;
      const double error = slow_px * vehicle.edge[k] + random.Normal(0.0, spec.edge_white_px);
      const bool is_cut = edges[k] <= 0.0 || edges[k] >= far;
      noisy[k] = std::clamp(edges[k] + (is_cut ? 0.0 : noise_scale * error), 0.0, far);
    }
    camera_box_t box{};
    box.left_px = noisy[0];
    box.top_px = noisy[1];
    box.width_px = noisy[2] - noisy[0];
    box.height_px = noisy[3] - noisy[1];
    if (box.width_px < 3.0 || box.height_px < 4.0) return;
    box.score =
        std::clamp(0.5 + 0.4 * std::min(1.0, box.height_px / 60.0) + random.Normal(0.0, 0.08),
                   std::min(0.99, camera.min_score + 0.02), 0.99);
    SetClass(object_class, box);
    picture.boxes.push_back(box);
  };
  if (!vehicle.is_split) {
    add({exact.left, exact.top, exact.right, exact.bottom});
  } else {
    const double cut = exact.left + (exact.right - exact.left) * random.Uniform(0.4, 0.6);
    add({exact.left, exact.top, cut, exact.bottom});
    add({cut, exact.top, exact.right, exact.bottom});
  }
  if (random.Bernoulli(spec.duplicate_share)) {
    const double by = 0.1 * (exact.right - exact.left);
    add({exact.left + by, exact.top + 0.5 * by, exact.right + 0.5 * by, exact.bottom});
  }
}

}  // namespace v2vouch::sim
