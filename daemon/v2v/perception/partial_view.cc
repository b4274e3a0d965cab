// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/perception/partial_view.h"

#include <algorithm>
#include <variant>

namespace v2vouch {
namespace {

constexpr double kExpectedSigma_m = 0.3;

bool IsOfAPart(const SensorMeasurement& measurement, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return radar->visible_share < config.part_share;
  }
  const auto* camera = std::get_if<CameraMeasurement>(&measurement);
  return camera != nullptr && (camera->left_is_cut || camera->right_is_cut);
}

bool IsPartlyCovered(const Occluder& expected, const SensorMeasurement& measurement,
                     const VisibilityMap& map, const BridgeConfig& config) {
  if (const auto* radar = std::get_if<RadarMeasurement>(&measurement)) {
    return map.FromRadar(radar->radar, expected).uncovered < config.part_share;
  }
  const auto* camera = std::get_if<CameraMeasurement>(&measurement);
  if (camera == nullptr) return false;
  const SensorView seen = map.FromCamera(camera->camera, expected);
  return seen.left_is_covered || seen.right_is_covered;
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

bool IsPartiallyObserved(const LocalTrack& track, const std::optional<Occluder>& expected,
                         const LocalFrame& frame, const VisibilityMap& map,
                         const BridgeConfig& config) {
  return std::ranges::any_of(frame.updates, [&](const SensorUpdate& update) {
    return update.track_id == track.id &&
           (IsOfAPart(update.measurement, config) ||
            (expected && IsPartlyCovered(*expected, update.measurement, map, config)));
  });
}

}  // namespace v2vouch
