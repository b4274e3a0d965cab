// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/objects/object_preprocessing.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/models/extent.h"

namespace v2vouch {
namespace {

// A velocity's direction is that of the axis from here on, and where it is this well known.
constexpr double kMoving_mps = 2.0;
constexpr double kMovingSigmas = 3.0;
constexpr double kLeastDirection_rad = 0.05;
// An axis that nobody told: most vehicles stand or drive along the road.
constexpr double kAssumedYawSigma_rad = 0.7;

// The ego as one sensor's frame of one frame sees it.
struct Scene {
  Scene(const ObjectSensorConfig& config, const EgoState& state)
      : sensor(config),
        ego(state),
        R_OB(state.X_OB.rotation()),
        origin_O((state.X_OB * Point<Body>{config.x_m, config.y_m}).vector()),
        yaw_rad(state.X_OB.yaw_rad() + config.yaw_rad) {
    R_OS << std::cos(yaw_rad), -std::sin(yaw_rad), std::sin(yaw_rad), std::cos(yaw_rad);
  }

  // Over ground, of a point that stands still in the sensor's frame.
  [[nodiscard]] Eigen::Vector2d VelocityAt(const Eigen::Vector2d& p_O) const {
    const Eigen::Vector2d lever = p_O - ego.X_OB.origin().vector();
    return R_OB.col(0) * ego.speed_mps +
           ego.yaw_rate_radps * Eigen::Vector2d(-lever.y(), lever.x());
  }

  const ObjectSensorConfig& sensor;
  const EgoState& ego;
  Eigen::Matrix2d R_OB;
  Eigen::Matrix2d R_OS;
  Eigen::Vector2d origin_O;
  double yaw_rad;
};

Eigen::Matrix2d Turned(const Eigen::Matrix2d& covariance, double sigma, const Scene& scene) {
  if (!(covariance(0, 0) > 0.0) || !(covariance(1, 1) > 0.0)) {
    return sigma * sigma * Eigen::Matrix2d::Identity();
  }
  const Eigen::Matrix2d turned = scene.R_OS * covariance * scene.R_OS.transpose();
  return 0.5 * (turned + turned.transpose());
}

void PutVelocity(const ObjectBox& object, const Scene& scene, BoxMeasurement& box) {
  if (!object.velocity_mps) return;
  box.velocity_O_mps = scene.R_OS * *object.velocity_mps;
  if (scene.sensor.velocity == VelocityReference::kSensor) {
    *box.velocity_O_mps += scene.VelocityAt({box.x_m, box.y_m});
  }
  box.velocity_covariance =
      Turned(object.velocity_covariance, scene.sensor.velocity_sigma_mps, scene);
}

void PutAxis(const ObjectBox& object, const Scene& scene, BoxMeasurement& box) {
  if (object.has_yaw) {
    box.yaw_rad = WrapAngle(object.yaw_rad + scene.yaw_rad);
    box.has_front = object.has_front;
    box.yaw_sigma_rad =
        object.yaw_sigma_rad > 0.0 ? object.yaw_sigma_rad : scene.sensor.yaw_sigma_rad;
    return;
  }
  box.yaw_rad = scene.ego.X_OB.yaw_rad();
  box.yaw_sigma_rad = kAssumedYawSigma_rad;
  if (!box.velocity_O_mps) return;
  const double speed_mps = box.velocity_O_mps->norm();
  const double sigma_mps = std::sqrt(0.5 * box.velocity_covariance.trace());
  if (speed_mps < kMoving_mps || speed_mps < kMovingSigmas * sigma_mps) return;
  box.yaw_rad = std::atan2(box.velocity_O_mps->y(), box.velocity_O_mps->x());
  box.yaw_sigma_rad = std::max(sigma_mps / speed_mps, kLeastDirection_rad);
}

bool IsUsable(const ObjectBox& object, const Scene& scene) {
  const double range_m = std::hypot(object.x_m, object.y_m);
  return object.score >= scene.sensor.min_score && range_m >= scene.sensor.min_range_m &&
         range_m <= scene.sensor.max_range_m &&
         std::abs(std::atan2(object.y_m, object.x_m)) <= scene.sensor.half_fov_rad;
}

bool IsOwnCar(const BoxMeasurement& box, const VehicleConfig& vehicle, const EgoState& ego) {
  const Point<Body> p_B = ego.X_OB.Inverse() * Point<Odometry>{box.x_m, box.y_m};
  return std::abs(p_B.x_m - vehicle.centre_x_m) < 0.5 * vehicle.length_m &&
         std::abs(p_B.y_m) < 0.5 * vehicle.width_m;
}

}  // namespace

void ProcessObjects(const ObjectList& list, const VehicleConfig& vehicle, const EgoState& ego,
                    std::vector<BoxMeasurement>& boxes) {
  boxes.clear();
  const Scene scene(vehicle.objects[static_cast<std::size_t>(list.sensor)], ego);
  for (const ObjectBox& object : list.objects) {
    if (!IsUsable(object, scene)) continue;
    BoxMeasurement box;
    const Eigen::Vector2d p_O =
        scene.origin_O + scene.R_OS * Eigen::Vector2d(object.x_m, object.y_m);
    box.x_m = p_O.x();
    box.y_m = p_O.y();
    if (IsOwnCar(box, vehicle, ego)) continue;
    box.position_covariance =
        Turned(object.position_covariance, scene.sensor.position_sigma_m, scene);
    PutVelocity(object, scene, box);
    PutAxis(object, scene, box);
    const Extent size = object.has_size
                            ? Extent{object.length_m, object.width_m, scene.sensor.length_sigma_m,
                                     scene.sensor.width_sigma_m}
                            : ClassExtent(object.object_class);
    box.length_m = size.length_m;
    box.width_m = size.width_m;
    box.length_sigma_m = size.length_sigma_m;
    box.width_sigma_m = size.width_sigma_m;
    box.object_class = object.object_class;
    box.score = object.score;
    box.sensor = list.sensor;
    boxes.push_back(box);
  }
}

}  // namespace v2vouch
