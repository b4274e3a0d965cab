// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/camera/camera_preprocessing.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "daemon/common/base/angle.h"

namespace v2vouch {
namespace {

constexpr double kBorder_px = 2.0;

// OpenCV's model: distorted = radial(r2) ideal + tangential(ideal).
struct Lens {
  explicit Lens(const std::vector<double>& coefficients) {
    double* const slots[] = {&k1, &k2, &p1, &p2, &k3};
    for (std::size_t i = 0; i < std::min<std::size_t>(coefficients.size(), 5); ++i) {
      *slots[i] = coefficients[i];
    }
  }
  double Radial(const Eigen::Vector2d& p) const {
    const double r2 = p.squaredNorm();
    return 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  }
  Eigen::Vector2d Tangential(const Eigen::Vector2d& p) const {
    const double xy = p.x() * p.y();
    const double r2 = p.squaredNorm();
    return {2.0 * p1 * xy + p2 * (r2 + 2.0 * p.x() * p.x()),
            p1 * (r2 + 2.0 * p.y() * p.y()) + 2.0 * p2 * xy};
  }
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

Eigen::Vector2d Undistort(const Lens& lens, const Eigen::Vector2d& distorted) {
  constexpr int kIterations = 100;
  constexpr double kConverged = 1e-12;  // A billionth of a pixel.
  constexpr double kUsable = 1e-4;      // A tenth of a pixel.
  Eigen::Vector2d ideal = distorted;
  for (int i = 0; i < kIterations; ++i) {
    const double radial = lens.Radial(ideal);
    if (!(radial > 0.0)) return distorted;
    const Eigen::Vector2d next = (distorted - lens.Tangential(ideal)) / radial;
    if (!next.allFinite()) return distorted;
    const double step = (next - ideal).norm();
    ideal = next;
    if (step < kConverged) return ideal;
  }
  const Eigen::Vector2d again = lens.Radial(ideal) * ideal + lens.Tangential(ideal);
  return (again - distorted).norm() < kUsable ? ideal : distorted;
}

// Share of a box's bottom edge that lies inside the one box that covers most of it. Of two boxes
// the one that reaches lower is nearer.
double CoveredBottom(const CameraBox& box, const CameraDetections& detections, double min_score) {
  const double bottom = box.top_px + box.height_px;
  double most = 0.0;
  for (const CameraBox& other : detections.boxes) {
    const bool is_nearer = other.top_px + other.height_px > bottom && other.top_px < bottom;
    if (!is_nearer || other.score < min_score) continue;
    const double width = std::min(box.left_px + box.width_px, other.left_px + other.width_px) -
                         std::max(box.left_px, other.left_px);
    most = std::max(most, width / box.width_px);
  }
  return most;
}

// Lorries and buses are higher than this, vans than the next.
constexpr double kLowestLorry_m = 2.3;
constexpr double kLowestVan_m = 1.8;

// A class name is evidence, not a size: networks call cars lorries. What is as low as a car is
// none, wherever its height can be told: from the angles to its foot and its top.
ObjectClass PlausibleClass(ObjectClass named, const CameraConfig& camera,
                           const CameraMeasurement& m) {
  if (named != ObjectClass::kTruck && named != ObjectClass::kBus) return named;
  if (m.bottom_is_cut || !(m.depression_rad > 2.0 * m.depression_sigma_rad)) return named;
  const double foot = std::tan(m.depression_rad);
  const double height_m = camera.z_m * (1.0 - std::tan(m.top_depression_rad) / foot);
  const double sigma_m = height_m * m.depression_sigma_rad / m.depression_rad;
  if (height_m + 2.0 * sigma_m > kLowestLorry_m) return named;
  return height_m > kLowestVan_m ? ObjectClass::kVan : ObjectClass::kCar;
}

bool IsUsable(const CameraBox& box, double min_score) {
  return std::isfinite(box.left_px) && std::isfinite(box.top_px) && box.width_px > 0.0 &&
         box.height_px > 0.0 && std::isfinite(box.width_px) && std::isfinite(box.height_px) &&
         box.score >= min_score;
}

}  // namespace

PixelAngles AnglesOfPixel(const CameraConfig& camera, double u_px, double v_px) {
  Eigen::Vector2d ray((u_px - camera.cx_px) / camera.fx_px, (v_px - camera.cy_px) / camera.fy_px);
  if (!camera.distortion.empty()) ray = Undistort(Lens(camera.distortion), ray);
  // Camera axes x right, y down, z forward -> x forward, y left, z up.
  const double left = -ray.x();
  const double up = -ray.y();
  const double cr = std::cos(camera.roll_rad);
  const double sr = std::sin(camera.roll_rad);
  const double rolled_left = cr * left - sr * up;
  const double rolled_up = sr * left + cr * up;
  const double cp = std::cos(camera.pitch_rad);
  const double sp = std::sin(camera.pitch_rad);
  const double forward = cp + sp * rolled_up;
  const double level_up = -sp + cp * rolled_up;
  return {std::atan2(rolled_left, forward),
          std::atan2(-level_up, std::hypot(forward, rolled_left))};
}

void ProcessCamera(const CameraDetections& detections, const CameraConfig& camera,
                   std::vector<CameraMeasurement>& measurements) {
  measurements.clear();
  const double width = camera.image_width_px;
  const double height = camera.image_height_px;
  const double scale_x = detections.image_width_px > 0 ? width / detections.image_width_px : 1.0;
  const double scale_y = detections.image_height_px > 0 ? height / detections.image_height_px : 1.0;
  for (const CameraBox& box : detections.boxes) {
    if (!IsUsable(box, camera.min_score)) continue;
    const double left = std::max(0.0, scale_x * box.left_px);
    const double right = std::min(width, scale_x * (box.left_px + box.width_px));
    const double top = std::max(0.0, scale_y * box.top_px);
    const double bottom = std::min(height, scale_y * (box.top_px + box.height_px));
    if (!(left < right && top < bottom)) continue;

    const double middle_u = 0.5 * (left + right);
    const double middle_v = 0.5 * (top + bottom);
    CameraMeasurement m;
    m.camera = detections.camera;
    m.azimuth_left_rad = AnglesOfPixel(camera, left, middle_v).azimuth_rad;
    m.azimuth_right_rad = AnglesOfPixel(camera, right, middle_v).azimuth_rad;
    m.depression_rad = AnglesOfPixel(camera, middle_u, bottom).depression_rad;
    // What one pixel is worth here, lens and mount included.
    const double azimuth_per_px =
        std::abs(AngleDifference(AnglesOfPixel(camera, middle_u - 0.5, middle_v).azimuth_rad,
                                 AnglesOfPixel(camera, middle_u + 0.5, middle_v).azimuth_rad));
    const double depression_per_px =
        std::abs(AnglesOfPixel(camera, middle_u, bottom + 0.5).depression_rad -
                 AnglesOfPixel(camera, middle_u, bottom - 0.5).depression_rad);
    m.azimuth_sigma_rad = camera.edge_sigma_px * azimuth_per_px;
    m.depression_sigma_rad =
        std::hypot(camera.edge_sigma_px * depression_per_px, camera.pitch_sigma_rad);
    m.left_is_cut = left <= kBorder_px;
    m.right_is_cut = right >= width - kBorder_px;
    m.bottom_is_cut =
        bottom >= height - kBorder_px ||
        (camera.covered_bottom_share < 1.0 &&
         CoveredBottom(box, detections, camera.min_score) > camera.covered_bottom_share);
    m.object_class = box.object_class;
    if (top > kBorder_px) {
      m.top_depression_rad = AnglesOfPixel(camera, middle_u, top).depression_rad;
      m.object_class = PlausibleClass(box.object_class, camera, m);
    }
    m.score = box.score;
    measurements.push_back(m);
  }
}

}  // namespace v2vouch
