// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/partial_view.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "daemon/local/visibility/box.h"

namespace v2vouch {
namespace {

constexpr double kExpectedSigma_m = 0.3;
constexpr double kOnVehicle_m = 0.5;  // Slack of a reflection round the expected footprint.

bool IsOfAPart(const SensorMeasurement& measurement, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return radar->visible_share < config.part_share;
  }
  if (const auto* box = std::get_if<BoxMeasurement>(&measurement)) {
    return box->visible_share < config.part_share;
  }
  const auto* camera = std::get_if<CameraMeasurement>(&measurement);
  return camera != nullptr && (camera->left_is_cut || camera->right_is_cut);
}

// A radar has measured a point on the vehicle where its sender has it, and the rest of it there
// lies behind something. Where the point is not on that footprint the claim has left the vehicle
// that the sensors see; a cover of the claimed position alone makes no partial observation.
bool IsOnPartlyCovered(const Occluder& expected, const SensorMeasurement& measurement,
                       const EgoState& ego, const V2vView& view, const VisibilityMap& map) {
  const auto* z = std::get_if<RadarMeasurement>(&measurement);
  if (z == nullptr) return false;
  const RadarConfig& radar = view.vehicle.radars[static_cast<std::size_t>(z->radar)];
  const double bearing_B = radar.yaw_rad + z->azimuth_rad;
  const Point<Odometry> p_O = ego.X_OB * Point<Body>{radar.x_m + z->range_m * std::cos(bearing_B),
                                                     radar.y_m + z->range_m * std::sin(bearing_B)};
  return Holds(Box(expected), p_O.vector(), kOnVehicle_m) &&
         map.From({SensorKind::kRadar, z->radar}, expected).uncovered <
             view.config.bridge.part_share;
}

}  // namespace

std::optional<Occluder> ExpectedFootprint(const V2vView& view, const LocalTrack& track,
                                          Timestamp stamp) {
  const PriorityVehicle* vehicle = view.list.SupportedBy(track.id);
  if (vehicle == nullptr) return std::nullopt;
  const SenderRecord* record = view.senders.Find(vehicle->sender);
  if (record == nullptr || !record->IsRecent(stamp)) return std::nullopt;
  const ResidualHistory& history = record->trust.history();
  if (!history.is_settled()) return std::nullopt;
  const ClaimInOdometry& claim = record->last;
  return Occluder{
      .id = track.id,
      .centre_O = claim.PlaceAt(stamp) - history.reference_O().value_or(history.mean_O()),
      .yaw_rad = claim.has_course ? claim.yaw_rad : track.state_O.mean[kYaw],
      .length_m = track.extent.length_m,
      .width_m = track.extent.width_m,
      .position_sigma_m = kExpectedSigma_m};
}

bool IsPartiallyObserved(const V2vView& view, const LocalTrack& track,
                         const std::optional<Occluder>& expected, const LocalFrame& frame,
                         const VisibilityMap& map) {
  return std::ranges::any_of(frame.updates, [&](const SensorUpdate& update) {
    return update.track_id == track.id &&
           (IsOfAPart(update.measurement, view.config.bridge) ||
            (expected && IsOnPartlyCovered(*expected, update.measurement, frame.ego, view, map)));
  });
}

}  // namespace v2vouch
