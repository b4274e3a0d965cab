// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/output_encoder.h"

#include <algorithm>

#include "daemon/common/base/angle.h"
#include "daemon/common/data/object_class.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/sensor_conversion.h"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/text_t.hpp"

namespace v2vouch::wire {
namespace {

// Below the decoder's limit, so that nothing of ours is refused by a reader of ours.
constexpr std::size_t kMaxTextBytes = (1u << 20) - 1;
constexpr std::size_t kMaxNameBytes = 255;
constexpr std::size_t kMaxTracks = 8192;
constexpr std::size_t kMaxSenders = 256;

template <class Count, class Vector>
void SetCount(Count& count, const Vector& vector) {
  count = static_cast<Count>(vector.size());
}

std::int64_t MicrosOrNever(const std::optional<Timestamp>& stamp) {
  return stamp ? ToMicros(*stamp) : 0;
}

void PutSender(SenderId sender, std::uint8_t* octets) {
  for (int i = 0; i < 4; ++i) octets[i] = static_cast<std::uint8_t>(sender >> (24 - 8 * i));
}

std::string Name(std::string_view text) { return std::string(text.substr(0, kMaxNameBytes)); }

void PutKinematics(const KinematicState& state, const Pose<Odometry, Body>& X_OB, track_t& to) {
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

  const StateMatrix& P_O = state.covariance;
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

track_t ToWire(const PublishedTrack& from, const Pose<Odometry, Body>& X_OB) {
  track_t to{};
  const LocalTrack& track = from.track;
  to.id = static_cast<std::int64_t>(track.id);
  to.local_id = static_cast<std::int64_t>(from.local_id);
  to.start_utime = ToMicros(track.start);
  PutKinematics(track.state_O, X_OB, to);
  to.length_m = track.extent.length_m;
  to.width_m = track.extent.width_m;
  to.length_sigma_m = track.extent.length_sigma_m;
  to.width_sigma_m = track.extent.width_sigma_m;
  to.object_class = static_cast<std::int8_t>(track.object_class);
  to.existence = track.existence;
  to.visibility = static_cast<std::int8_t>(track.visibility);
  to.is_confirmed = track.is_confirmed ? 1 : 0;
  to.last_radar_utime = MicrosOrNever(track.last_radar);
  to.last_camera_utime = MicrosOrNever(track.last_camera);
  to.last_v2v_utime = MicrosOrNever(from.last_v2v);
  PutSender(from.sender, to.v2v_id);
  to.trust_state = static_cast<std::int8_t>(from.trust);
  to.bridge_budget_s = from.bridge_budget_s;
  to.latitude_rad = from.position ? from.position->latitude_rad : kNaN;
  to.longitude_rad = from.position ? from.position->longitude_rad : kNaN;
  to.bias_east_m = from.bias_east_m;
  to.bias_north_m = from.bias_north_m;
  return to;
}

void PutBias(const std::optional<BiasEstimate>& bias, double& east_m, double& north_m,
             double (&covariance_m2)[4]) {
  east_m = bias ? bias->mean_en.x() : kNaN;
  north_m = bias ? bias->mean_en.y() : kNaN;
  for (int i = 0; i < 4; ++i) covariance_m2[i] = bias ? bias->covariance(i / 2, i % 2) : kNaN;
}

gps_bias_t ToWire(const BiasReport& report) {
  gps_bias_t to{};
  to.utime = MicrosOrNever(report.solved_at);
  PutBias(report.common, to.common_east_m, to.common_north_m, to.common_covariance_m2);
  const std::size_t count = std::min(report.senders.size(), kMaxSenders);
  for (std::size_t i = 0; i < count; ++i) {
    const BiasReport::Sender& from = report.senders[i];
    sender_bias_t sender{};
    PutSender(from.sender, sender.v2v_id);
    sender.verdict = static_cast<std::int8_t>(from.verdict);
    const bool has_bias = from.verdict != BiasVerdict::kTooFew;
    PutBias(has_bias ? std::optional(from.bias) : std::nullopt, sender.east_m, sender.north_m,
            sender.covariance_m2);
    if (has_bias) ++(from.verdict == BiasVerdict::kUsed ? to.num_used : to.num_quarantined);
    to.senders.push_back(sender);
  }
  SetCount(to.num_senders, to.senders);
  return to;
}

}  // namespace

track_list_t ToWire(const TrackList& list) {
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
  for (std::size_t i = 0; i < count; ++i) to.tracks.push_back(ToWire(list.tracks[i], list.X_OB));
  SetCount(to.num_tracks, to.tracks);
  return to;
}

void EncodeList(const TrackList& list, std::vector<std::uint8_t>& bytes) {
  Encode(ToWire(list), bytes);
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

void EncodeStatus(const Status& status, std::vector<std::uint8_t>& bytes) {
  daemon_status_t to{};
  to.utime = ToMicros(status.stamp);
  to.seq = status.seq;
  to.version = Name(status.version);
  to.calibration = Name(status.calibration);
  for (const InputStatus& from : status.inputs) {
    input_status_t input{};
    input.channel = Name(from.channel);
    input.received = from.received;
    input.accepted = from.accepted;
    input.gaps = from.gaps;
    input.rate_hz = from.rate_hz;
    input.age_s = from.age_s;
    input.is_silent = from.is_silent ? 1 : 0;
    to.inputs.push_back(input);
  }
  SetCount(to.num_inputs, to.inputs);
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    if (status.refusals[i] == 0) continue;
    count_t count{};
    count.name = Name(ReasonName(static_cast<Reason>(i)));
    count.count = static_cast<std::int64_t>(status.refusals[i]);
    to.refusals.push_back(count);
  }
  SetCount(to.num_refusals, to.refusals);
  for (const RefusalDetail& from : status.refusal_details) {
    refusal_t detail{};
    detail.channel = Name(from.channel);
    detail.reason = Name(ReasonName(from.refusal.reason));
    detail.field = Name(from.FieldText());
    detail.count = static_cast<std::int64_t>(from.count);
    to.refusal_details.push_back(detail);
  }
  SetCount(to.num_refusal_details, to.refusal_details);
  to.queue_drops_own = status.queue_drops_own;
  to.queue_drops_bsm = status.queue_drops_bsm;
  to.kernel_drops = status.kernel_drops;
  to.receive_buffer_bytes = status.receive_buffer_bytes;
  for (const StageLatency& from : status.latencies) {
    stage_latency_t latency{};
    latency.stage = Name(from.stage);
    latency.p50_us = from.p50_us;
    latency.p99_us = from.p99_us;
    latency.max_us = from.max_us;
    to.latencies.push_back(latency);
  }
  SetCount(to.num_latencies, to.latencies);
  to.local_tracks = status.local_tracks;
  to.priority_tracks = status.priority_tracks;
  to.v2v_senders = status.v2v_senders;
  to.ego_gnss_suspect = status.ego_gnss_suspect ? 1 : 0;
  to.gps_bias = ToWire(status.gps_bias);
  for (const MountStatus& from : status.mounts) {
    mount_status_t mount{};
    mount.sensor = Name(from.sensor);
    mount.utime = ToMicros(from.stamp);
    mount.yaw_correction_rad = from.yaw_correction_rad;
    mount.yaw_sigma_rad = from.yaw_sigma_rad;
    mount.windows = from.windows;
    mount.suspicious_run = from.suspicious_run;
    mount.has_moved = from.has_moved ? 1 : 0;
    mount.driven_s = from.driven_s;
    to.mounts.push_back(mount);
  }
  SetCount(to.num_mounts, to.mounts);
  for (const NoticeStatus& from : status.notices) {
    notice_t notice{};
    notice.name = Name(from.name);
    notice.channel = Name(from.channel);
    notice.value = from.value;
    notice.since_utime = ToMicros(from.since);
    notice.advice = Name(from.advice);
    to.notices.push_back(notice);
  }
  SetCount(to.num_notices, to.notices);
  to.digest_inputs = status.digest_inputs;
  to.digest_local = Name(status.digest_local);
  to.digest_priority = Name(status.digest_priority);
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
