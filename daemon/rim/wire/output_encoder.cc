// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/output_encoder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/object_class.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/output_fields.h"
#include "daemon/rim/wire/sensor_conversion.h"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/text_t.hpp"

namespace v2vouch::wire {
namespace {

// Below the decoder's limit, so that nothing of ours is refused by a reader of ours.
constexpr std::size_t kMaxTextBytes = (1u << 20) - 1;
constexpr std::size_t kMaxTracks = 8192;
void PutKinematics(const LocalTrack& track, const Pose<Odometry, Body>& X_OB, track_t& to) {
  const KinematicState& state = track.state_O;
  const StateVector& x = state.mean;
  const Point<Body> p_BT = X_OB.Inverse() * Point<Odometry>{x[kX], x[kY]};
  to.x_body_m = p_BT.x_m;
  to.y_body_m = p_BT.y_m;
  to.yaw_body_rad = WrapAngle(x[kYaw] - X_OB.yaw_rad());
  to.x_odom_m = x[kX];
  to.y_odom_m = x[kY];
  to.yaw_odom_rad = WrapAngle(x[kYaw]);
  to.speed_mps = x[kSpeed];
  to.yaw_rate_radps = x[kYawRate];
  to.accel_mps2 = x[kAccel];

  StateMatrix P_O = state.covariance;
  P_O.topLeftCorner<2, 2>() += track.lasting_variance_m2 * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d R_BO = X_OB.rotation().transpose();
  StateMatrix P_B = P_O;
  P_B.topLeftCorner<2, 2>() = R_BO * P_O.topLeftCorner<2, 2>() * R_BO.transpose();
  P_B.topRightCorner<2, 4>() = R_BO * P_O.topRightCorner<2, 4>();
  P_B.bottomLeftCorner<4, 2>() = P_O.bottomLeftCorner<4, 2>() * R_BO.transpose();
  for (int row = 0; row < kStateSize; ++row) {
    for (int column = 0; column < kStateSize; ++column) {
      to.covariance_odom[row * kStateSize + column] = P_O(row, column);
      to.covariance_body[row * kStateSize + column] = P_B(row, column);
    }
  }
}

void PutSources(const PublishedTrack& from, const VehicleConfig& vehicle, track_t& to) {
  static_assert(static_cast<int>(SensorKind::kRadar) == 0 && kSensorKinds == 3);
  const auto sources = from.track.support.sources();
  std::array<SensorSupport::Source, SensorSupport::kMostSources> sorted;
  const auto end = std::copy(sources.begin(), sources.end(), sorted.begin());
  std::sort(sorted.begin(), end, [](const auto& a, const auto& b) { return a.sensor < b.sensor; });
  to.sources.reserve(sources.size() + 1);
  const auto add = [&to](int kind, std::string name, Timestamp last) {
    track_source_t source{};
    source.kind = static_cast<std::int8_t>(kind);
    source.name = std::move(name);
    source.last_utime = ToMicros(last);
    to.sources.push_back(std::move(source));
  };
  for (auto source = sorted.begin(); source != end; ++source) {
    add(static_cast<int>(source->sensor.kind), vehicle.NameOf(source->sensor), source->last);
  }
  if (from.last_v2v) add(track_source_t::V2V, {}, *from.last_v2v);
  SetCount(to.num_sources, to.sources);
}

track_t ToWire(const PublishedTrack& from, const VehicleConfig& vehicle,
               const Pose<Odometry, Body>& X_OB) {
  track_t to{};
  const LocalTrack& track = from.track;
  to.id = static_cast<std::int64_t>(track.id);
  to.local_id = static_cast<std::int64_t>(from.local_id);
  to.start_utime = ToMicros(track.start);
  PutKinematics(track, X_OB, to);
  to.length_m = track.extent.length_m;
  to.width_m = track.extent.width_m;
  to.length_sigma_m = track.extent.length_sigma_m;
  to.width_sigma_m = track.extent.width_sigma_m;
  to.object_class = static_cast<std::int8_t>(track.object_class);
  to.existence = track.existence;
  to.visibility = static_cast<std::int8_t>(track.visibility);
  to.is_confirmed = track.is_confirmed ? 1 : 0;
  PutSources(from, vehicle, to);
  PutSender(from.sender, to.v2v_id);
  to.trust_state = static_cast<std::int8_t>(from.trust);
  to.bridge_budget_s = from.bridge_budget_s;
  to.latitude_rad = from.position ? from.position->latitude_rad : kNaN;
  to.longitude_rad = from.position ? from.position->longitude_rad : kNaN;
  to.bias_east_m = from.bias_east_m;
  to.bias_north_m = from.bias_north_m;
  to.events = from.events;
  return to;
}

}  // namespace

track_list_t ToWire(const TrackList& list, const VehicleConfig& vehicle) {
  track_list_t to{};
  to.utime = ToMicros(list.stamp);
  to.seq = list.seq;
  to.revision = list.revision;
  to.stale = list.stale ? 1 : 0;
  to.ego_gnss_suspect = list.ego_gnss_suspect ? 1 : 0;
  to.ego_x_odom_m = list.X_OB.x_m();
  to.ego_y_odom_m = list.X_OB.y_m();
  to.ego_yaw_odom_rad = list.X_OB.yaw_rad();
  to.sectors.reserve(list.sectors.size());
  for (const SectorHealth& sector : list.sectors) {
    sector_health_t health{};
    health.from_rad = sector.from_rad;
    health.to_rad = sector.to_rad;
    health.range_m = sector.range_m;
    health.state = static_cast<std::int8_t>(sector.state);
    to.sectors.push_back(health);
  }
  SetCount(to.num_sectors, to.sectors);
  const std::size_t count = std::min(list.tracks.size(), kMaxTracks);
  to.tracks.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    to.tracks.push_back(ToWire(list.tracks[i], vehicle, list.X_OB));
  }
  SetCount(to.num_tracks, to.tracks);
  return to;
}

void EncodeList(const TrackList& list, const VehicleConfig& vehicle,
                std::vector<std::uint8_t>& bytes) {
  Encode(ToWire(list, vehicle), bytes);
}

void EncodeReport(const MisbehaviorReport& report, std::vector<std::uint8_t>& bytes) {
  misbehavior_report_t to{};
  to.utime = ToMicros(report.stamp);
  PutSender(report.sender, to.sender_id);
  std::copy(report.certificate.begin(), report.certificate.end(), to.certificate_digest);
  to.check = Name(NameOf(report.check));
  to.verdict = static_cast<std::int8_t>(report.verdict);
  to.etsi_class = static_cast<std::int8_t>(Describe(report.check).etsi_class);
  to.is_j3287 = CheckInfo::kIsJ3287 ? 1 : 0;
  for (const Evidence& evidence : report.evidence) {
    evidence_t figure{};
    figure.name = Name(evidence.name);
    figure.value = evidence.value;
    to.evidence.push_back(figure);
  }
  SetCount(to.num_evidence, to.evidence);
  Encode(to, bytes);
}

void EncodeVerdict(const BsmVerdict& verdict, std::vector<std::uint8_t>& bytes) {
  bsm_verdict_t to{};
  to.utime = ToMicros(verdict.stamp);
  to.seq = verdict.seq;
  PutSender(verdict.sender, to.sender_id);
  to.trust_state = static_cast<std::int8_t>(verdict.trust);
  if (verdict.refusal) to.refusal = Name(ReasonName(*verdict.refusal));
  Encode(to, bytes);
}

void EncodeDetections(const CameraDetections& detections, const CameraConfig& camera,
                      std::vector<std::uint8_t>& bytes) {
  camera_detections_t to{};
  to.utime = ToMicros(detections.stamp - FromSeconds(camera.clock_offset_s));
  to.seq = detections.seq;
  to.sensor = Name(camera.name);
  to.image_width_px = detections.image_width_px;
  to.image_height_px = detections.image_height_px;
  for (const CameraBox& from : detections.boxes) {
    camera_box_t box{};
    box.left_px = from.left_px;
    box.top_px = from.top_px;
    box.width_px = from.width_px;
    box.height_px = from.height_px;
    box.class_id = -1;
    box.class_name = ObjectClassName(from.object_class);
    box.score = from.score;
    to.boxes.push_back(box);
  }
  SetCount(to.num_boxes, to.boxes);
  Encode(to, bytes);
}

void EncodeCalibration(const CalibrationInForce& calibration, std::vector<std::uint8_t>& bytes) {
  calibration_t to{};
  to.utime = ToMicros(calibration.stamp);
  to.source = Name(calibration.source);
  to.checksum = Name(calibration.checksum);
  for (const CalibrationParameter& from : calibration.parameters) {
    calibration_parameter_t parameter{};
    parameter.name = Name(from.name);
    parameter.value = from.value;
    parameter.std = from.std;
    parameter.verdict = Name(from.verdict);
    to.parameters.push_back(parameter);
  }
  SetCount(to.num_parameters, to.parameters);
  Encode(to, bytes);
}

void EncodeText(Timestamp stamp, const std::string& name, const std::string& text,
                std::vector<std::uint8_t>& bytes) {
  text_t to{};
  to.utime = ToMicros(stamp);
  to.name = Name(name);
  to.text = text.substr(0, kMaxTextBytes);
  to.text.erase(std::remove(to.text.begin(), to.text.end(), '\0'), to.text.end());
  Encode(to, bytes);
}

}  // namespace v2vouch::wire
