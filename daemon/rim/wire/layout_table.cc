// SPDX-License-Identifier: Apache-2.0
// The fields of every type of lcmtypes/, once more, with what lcm-gen's own table lacks: how much
// of each a decoder may believe. tests/daemon/rim/wire/layout_test.cc keeps this equal to the .lcm
// files.
#include "daemon/rim/wire/layout.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_parameter_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_box_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/count_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/evidence_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/gps_bias_t.hpp"
#include "v2vouch/input_status_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/mount_status_t.hpp"
#include "v2vouch/notice_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/object_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/path_point_t.hpp"
#include "v2vouch/radar_detection_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/refusal_t.hpp"
#include "v2vouch/sector_health_t.hpp"
#include "v2vouch/sender_bias_t.hpp"
#include "v2vouch/stage_latency_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/track_source_t.hpp"
#include "v2vouch/track_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/truth_object_t.hpp"
#include "v2vouch/truth_sensor_t.hpp"
#include "v2vouch/warning_list_t.hpp"
#include "v2vouch/warning_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr int kMaxNameBytes = 256;
constexpr int kMaxTextBytes = 1 << 20;
constexpr int kMaxImageBytes = 16 << 20;  // 1920 x 1080 bgr8 takes 6.2 million.

constexpr Field kBsmFields[] = {
    {.name = "rx_utime", .kind = Kind::kInt64},
    {.name = "generation_utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "msgCnt", .kind = Kind::kInt16},
    {.name = "id", .kind = Kind::kByte, .fixed = 4},
    {.name = "secMark", .kind = Kind::kInt32},
    {.name = "lat", .kind = Kind::kInt32},
    {.name = "long_", .kind = Kind::kInt32},
    {.name = "elev", .kind = Kind::kInt32},
    {.name = "semiMajor", .kind = Kind::kInt16},
    {.name = "semiMinor", .kind = Kind::kInt16},
    {.name = "orientation", .kind = Kind::kInt32},
    {.name = "transmission", .kind = Kind::kInt8},
    {.name = "speed", .kind = Kind::kInt16},
    {.name = "heading", .kind = Kind::kInt32},
    {.name = "angle", .kind = Kind::kInt16},
    {.name = "accelSet_long", .kind = Kind::kInt16},
    {.name = "accelSet_lat", .kind = Kind::kInt16},
    {.name = "accelSet_vert", .kind = Kind::kInt16},
    {.name = "accelSet_yaw", .kind = Kind::kInt32},
    {.name = "wheelBrakes", .kind = Kind::kInt8},
    {.name = "traction", .kind = Kind::kInt8},
    {.name = "abs", .kind = Kind::kInt8},
    {.name = "scs", .kind = Kind::kInt8},
    {.name = "brakeBoost", .kind = Kind::kInt8},
    {.name = "auxBrakes", .kind = Kind::kInt8},
    {.name = "width", .kind = Kind::kInt16},
    {.name = "length", .kind = Kind::kInt16},
    {.name = "signature_state", .kind = Kind::kInt8},
    {.name = "certificate_digest", .kind = Kind::kByte, .fixed = 8},
    {.name = "rssi_dbm", .kind = Kind::kFloat},
};
constexpr Layout kBsm = MakeLayout("bsm_t", kBsmFields, 256);

constexpr Field kCalibrationParameterFields[] = {
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "value", .kind = Kind::kDouble},
    {.name = "std", .kind = Kind::kDouble},
    {.name = "verdict", .kind = Kind::kString, .max_length = kMaxNameBytes},
};
constexpr Layout kCalibrationParameter =
    MakeLayout("calibration_parameter_t", kCalibrationParameterFields);

constexpr Field kCalibrationFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "source", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "checksum", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "num_parameters", .kind = Kind::kInt32},
    {.name = "parameters",
     .kind = Kind::kStruct,
     .type = &kCalibrationParameter,
     .max_count = 1024},
};
constexpr Layout kCalibration = MakeLayout("calibration_t", kCalibrationFields, 512 * 1024);

constexpr Field kCameraBoxFields[] = {
    {.name = "left_px", .kind = Kind::kDouble},
    {.name = "top_px", .kind = Kind::kDouble},
    {.name = "width_px", .kind = Kind::kDouble},
    {.name = "height_px", .kind = Kind::kDouble},
    {.name = "class_id", .kind = Kind::kInt32},
    {.name = "class_name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "score", .kind = Kind::kDouble},
};
constexpr Layout kCameraBox = MakeLayout("camera_box_t", kCameraBoxFields);

constexpr Field kCameraDetectionsFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "image_width_px", .kind = Kind::kInt32},
    {.name = "image_height_px", .kind = Kind::kInt32},
    {.name = "num_boxes", .kind = Kind::kInt32},
    {.name = "boxes", .kind = Kind::kStruct, .type = &kCameraBox, .max_count = 512},
};
constexpr Layout kCameraDetections =
    MakeLayout("camera_detections_t", kCameraDetectionsFields, 256 * 1024);

constexpr Field kCameraImageFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "width_px", .kind = Kind::kInt32},
    {.name = "height_px", .kind = Kind::kInt32},
    {.name = "encoding", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "num_bytes", .kind = Kind::kInt32},
    {.name = "data", .kind = Kind::kByte, .max_count = kMaxImageBytes},
};
constexpr Layout kCameraImage =
    MakeLayout("camera_image_t", kCameraImageFields, kMaxImageBytes + 1024);

constexpr Field kCountFields[] = {
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "count", .kind = Kind::kInt64},
};
constexpr Layout kCount = MakeLayout("count_t", kCountFields);

constexpr Field kInputStatusFields[] = {
    {.name = "channel", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "received", .kind = Kind::kInt64},
    {.name = "accepted", .kind = Kind::kInt64},
    {.name = "gaps", .kind = Kind::kInt64},
    {.name = "rate_hz", .kind = Kind::kDouble},
    {.name = "age_s", .kind = Kind::kDouble},
    {.name = "is_silent", .kind = Kind::kInt8},
};
constexpr Layout kInputStatus = MakeLayout("input_status_t", kInputStatusFields);

constexpr Field kStageLatencyFields[] = {
    {.name = "stage", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "p50_us", .kind = Kind::kDouble},
    {.name = "p99_us", .kind = Kind::kDouble},
    {.name = "max_us", .kind = Kind::kDouble},
};
constexpr Layout kStageLatency = MakeLayout("stage_latency_t", kStageLatencyFields);

constexpr Field kSenderBiasFields[] = {
    {.name = "v2v_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "verdict", .kind = Kind::kInt8},
    {.name = "east_m", .kind = Kind::kDouble},
    {.name = "north_m", .kind = Kind::kDouble},
    {.name = "covariance_m2", .kind = Kind::kDouble, .fixed = 4},
};
constexpr Layout kSenderBias = MakeLayout("sender_bias_t", kSenderBiasFields);

constexpr Field kGpsBiasFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "num_used", .kind = Kind::kInt32},
    {.name = "num_quarantined", .kind = Kind::kInt32},
    {.name = "common_east_m", .kind = Kind::kDouble},
    {.name = "common_north_m", .kind = Kind::kDouble},
    {.name = "common_covariance_m2", .kind = Kind::kDouble, .fixed = 4},
    {.name = "num_senders", .kind = Kind::kInt32},
    {.name = "senders", .kind = Kind::kStruct, .type = &kSenderBias, .max_count = 256},
};
constexpr Layout kGpsBias = MakeLayout("gps_bias_t", kGpsBiasFields);

constexpr Field kMountStatusFields[] = {
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "yaw_correction_rad", .kind = Kind::kDouble},
    {.name = "yaw_sigma_rad", .kind = Kind::kDouble},
    {.name = "windows", .kind = Kind::kInt32},
    {.name = "suspicious_run", .kind = Kind::kInt32},
    {.name = "has_moved", .kind = Kind::kInt8},
    {.name = "driven_s", .kind = Kind::kDouble},
};
constexpr Layout kMountStatus = MakeLayout("mount_status_t", kMountStatusFields);

constexpr Field kNoticeFields[] = {
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "channel", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "value", .kind = Kind::kDouble},
    {.name = "since_utime", .kind = Kind::kInt64},
    {.name = "advice", .kind = Kind::kString, .max_length = kMaxNameBytes},
};
constexpr Layout kNotice = MakeLayout("notice_t", kNoticeFields);

constexpr Field kObuStatusFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "version", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "datagrams", .kind = Kind::kInt64},
    {.name = "published", .kind = Kind::kInt64},
    {.name = "publish_failures", .kind = Kind::kInt64},
    {.name = "duplicates", .kind = Kind::kInt64},
    {.name = "kernel_drops", .kind = Kind::kInt64},
    {.name = "receive_buffer_bytes", .kind = Kind::kInt64},
    {.name = "senders", .kind = Kind::kInt32},
    {.name = "certificates", .kind = Kind::kInt32},
    {.name = "silent_s", .kind = Kind::kDouble},
    {.name = "obu_silent", .kind = Kind::kInt8},
    {.name = "clock_offset_s", .kind = Kind::kDouble},
    {.name = "clock_suspect", .kind = Kind::kInt8},
    {.name = "own_state", .kind = Kind::kInt8},
    {.name = "own_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "own_sent", .kind = Kind::kInt64},
    {.name = "own_send_failures", .kind = Kind::kInt64},
    {.name = "num_framings", .kind = Kind::kInt32},
    {.name = "framings", .kind = Kind::kStruct, .type = &kCount, .max_count = 64},
    {.name = "num_refusals", .kind = Kind::kInt32},
    {.name = "refusals", .kind = Kind::kStruct, .type = &kCount, .max_count = 64},
    {.name = "num_signatures", .kind = Kind::kInt32},
    {.name = "signatures", .kind = Kind::kStruct, .type = &kCount, .max_count = 64},
    {.name = "num_sources", .kind = Kind::kInt32},
    {.name = "sources", .kind = Kind::kStruct, .type = &kCount, .max_count = 128},
};
constexpr Layout kObuStatus = MakeLayout("obu_status_t", kObuStatusFields, 256 * 1024);

constexpr Field kRefusalFields[] = {
    {.name = "channel", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "reason", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "field", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "count", .kind = Kind::kInt64},
};
constexpr Layout kRefusal = MakeLayout("refusal_t", kRefusalFields);

constexpr Field kDaemonStatusFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "version", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "calibration", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "num_inputs", .kind = Kind::kInt32},
    {.name = "inputs", .kind = Kind::kStruct, .type = &kInputStatus, .max_count = 256},
    {.name = "num_refusals", .kind = Kind::kInt32},
    {.name = "refusals", .kind = Kind::kStruct, .type = &kCount, .max_count = 256},
    {.name = "num_refusal_details", .kind = Kind::kInt32},
    {.name = "refusal_details", .kind = Kind::kStruct, .type = &kRefusal, .max_count = 256},
    {.name = "queue_drops_own", .kind = Kind::kInt64},
    {.name = "queue_drops_bsm", .kind = Kind::kInt64},
    {.name = "kernel_drops", .kind = Kind::kInt64},
    {.name = "receive_buffer_bytes", .kind = Kind::kInt64},
    {.name = "num_latencies", .kind = Kind::kInt32},
    {.name = "latencies", .kind = Kind::kStruct, .type = &kStageLatency, .max_count = 64},
    {.name = "local_tracks", .kind = Kind::kInt32},
    {.name = "priority_tracks", .kind = Kind::kInt32},
    {.name = "v2v_senders", .kind = Kind::kInt32},
    {.name = "ego_gnss_suspect", .kind = Kind::kInt8},
    {.name = "gps_bias", .kind = Kind::kStruct, .type = &kGpsBias},
    {.name = "num_mounts", .kind = Kind::kInt32},
    {.name = "mounts", .kind = Kind::kStruct, .type = &kMountStatus, .max_count = 64},
    {.name = "num_notices", .kind = Kind::kInt32},
    {.name = "notices", .kind = Kind::kStruct, .type = &kNotice, .max_count = 256},
    {.name = "digest_inputs", .kind = Kind::kInt64},
    {.name = "digest_local", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "digest_priority", .kind = Kind::kString, .max_length = kMaxNameBytes},
};
constexpr Layout kDaemonStatus = MakeLayout("daemon_status_t", kDaemonStatusFields, 256 * 1024);

constexpr Field kEgoMotionFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "speed_mps", .kind = Kind::kDouble},
    {.name = "speed_sigma_mps", .kind = Kind::kDouble},
    {.name = "yaw_rate_radps", .kind = Kind::kDouble},
    {.name = "yaw_rate_sigma_radps", .kind = Kind::kDouble},
    {.name = "accel_long_mps2", .kind = Kind::kDouble},
    {.name = "accel_long_sigma_mps2", .kind = Kind::kDouble},
    {.name = "accel_lat_mps2", .kind = Kind::kDouble},
    {.name = "accel_lat_sigma_mps2", .kind = Kind::kDouble},
    {.name = "gear", .kind = Kind::kInt8},
};
constexpr Layout kEgoMotion = MakeLayout("ego_motion_t", kEgoMotionFields, 256);

constexpr Field kEvidenceFields[] = {
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "value", .kind = Kind::kDouble},
};
constexpr Layout kEvidence = MakeLayout("evidence_t", kEvidenceFields);

constexpr Field kGnssFixFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "latitude_rad", .kind = Kind::kDouble},
    {.name = "longitude_rad", .kind = Kind::kDouble},
    {.name = "altitude_m", .kind = Kind::kDouble},
    {.name = "covariance_enu_m2", .kind = Kind::kDouble, .fixed = 9},
    {.name = "heading_rad", .kind = Kind::kDouble},
    {.name = "heading_sigma_rad", .kind = Kind::kDouble},
    {.name = "velocity_east_mps", .kind = Kind::kDouble},
    {.name = "velocity_north_mps", .kind = Kind::kDouble},
    {.name = "velocity_up_mps", .kind = Kind::kDouble},
    {.name = "velocity_sigma_mps", .kind = Kind::kDouble},
    {.name = "fix_type", .kind = Kind::kInt8},
};
constexpr Layout kGnssFix = MakeLayout("gnss_fix_t", kGnssFixFields, 512);

constexpr Field kMisbehaviorReportFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "sender_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "certificate_digest", .kind = Kind::kByte, .fixed = 8},
    {.name = "check", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "verdict", .kind = Kind::kInt8},
    {.name = "etsi_class", .kind = Kind::kInt8},
    {.name = "is_j3287", .kind = Kind::kInt8},
    {.name = "num_evidence", .kind = Kind::kInt32},
    {.name = "evidence", .kind = Kind::kStruct, .type = &kEvidence, .max_count = 64},
};
constexpr Layout kMisbehaviorReport =
    MakeLayout("misbehavior_report_t", kMisbehaviorReportFields, 32 * 1024);

constexpr Field kBsmVerdictFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sender_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "trust_state", .kind = Kind::kInt8},
    {.name = "refusal", .kind = Kind::kString, .max_length = kMaxNameBytes},
};
constexpr Layout kBsmVerdict = MakeLayout("bsm_verdict_t", kBsmVerdictFields, 1024);

constexpr Field kObjectFields[] = {
    {.name = "x_m", .kind = Kind::kDouble},
    {.name = "y_m", .kind = Kind::kDouble},
    {.name = "yaw_rad", .kind = Kind::kDouble},
    {.name = "has_front", .kind = Kind::kInt8},
    {.name = "length_m", .kind = Kind::kDouble},
    {.name = "width_m", .kind = Kind::kDouble},
    {.name = "height_m", .kind = Kind::kDouble},
    {.name = "velocity_x_mps", .kind = Kind::kDouble},
    {.name = "velocity_y_mps", .kind = Kind::kDouble},
    {.name = "covariance", .kind = Kind::kDouble, .fixed = 25},
    {.name = "class_name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "score", .kind = Kind::kDouble},
    {.name = "id", .kind = Kind::kInt64},
};
constexpr Layout kObject = MakeLayout("object_t", kObjectFields);

constexpr Field kObjectListFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "num_objects", .kind = Kind::kInt32},
    {.name = "objects", .kind = Kind::kStruct, .type = &kObject, .max_count = 512},
};
constexpr Layout kObjectList = MakeLayout("object_list_t", kObjectListFields, 512 * 1024);

constexpr Field kRadarDetectionFields[] = {
    {.name = "range_m", .kind = Kind::kDouble},
    {.name = "azimuth_rad", .kind = Kind::kDouble},
    {.name = "range_rate_mps", .kind = Kind::kDouble},
    {.name = "rcs_dbsm", .kind = Kind::kDouble},
    {.name = "snr_db", .kind = Kind::kDouble},
    {.name = "track_id", .kind = Kind::kInt32},
};
constexpr Layout kRadarDetection = MakeLayout("radar_detection_t", kRadarDetectionFields);

constexpr Field kRadarScanFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "num_detections", .kind = Kind::kInt32},
    {.name = "detections", .kind = Kind::kStruct, .type = &kRadarDetection, .max_count = 1024},
};
constexpr Layout kRadarScan = MakeLayout("radar_scan_t", kRadarScanFields, 64 * 1024);

constexpr Field kSectorHealthFields[] = {
    {.name = "from_rad", .kind = Kind::kDouble},
    {.name = "to_rad", .kind = Kind::kDouble},
    {.name = "range_m", .kind = Kind::kDouble},
    {.name = "state", .kind = Kind::kInt8},
};
constexpr Layout kSectorHealth = MakeLayout("sector_health_t", kSectorHealthFields);

constexpr Field kTextFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "text", .kind = Kind::kString, .max_length = kMaxTextBytes},
};
constexpr Layout kText = MakeLayout("text_t", kTextFields, kMaxTextBytes + 1024);

constexpr Field kTrackSourceFields[] = {
    {.name = "kind", .kind = Kind::kInt8},
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "last_utime", .kind = Kind::kInt64},
};
constexpr Layout kTrackSource = MakeLayout("track_source_t", kTrackSourceFields);

constexpr Field kTrackFields[] = {
    {.name = "id", .kind = Kind::kInt64},
    {.name = "local_id", .kind = Kind::kInt64},
    {.name = "start_utime", .kind = Kind::kInt64},
    {.name = "x_body_m", .kind = Kind::kDouble},
    {.name = "y_body_m", .kind = Kind::kDouble},
    {.name = "yaw_body_rad", .kind = Kind::kDouble},
    {.name = "x_odom_m", .kind = Kind::kDouble},
    {.name = "y_odom_m", .kind = Kind::kDouble},
    {.name = "yaw_odom_rad", .kind = Kind::kDouble},
    {.name = "speed_mps", .kind = Kind::kDouble},
    {.name = "yaw_rate_radps", .kind = Kind::kDouble},
    {.name = "accel_mps2", .kind = Kind::kDouble},
    {.name = "covariance_body", .kind = Kind::kDouble, .fixed = 36},
    {.name = "covariance_odom", .kind = Kind::kDouble, .fixed = 36},
    {.name = "length_m", .kind = Kind::kDouble},
    {.name = "width_m", .kind = Kind::kDouble},
    {.name = "length_sigma_m", .kind = Kind::kDouble},
    {.name = "width_sigma_m", .kind = Kind::kDouble},
    {.name = "object_class", .kind = Kind::kInt8},
    {.name = "existence", .kind = Kind::kDouble},
    {.name = "visibility", .kind = Kind::kInt8},
    {.name = "is_confirmed", .kind = Kind::kInt8},
    {.name = "num_sources", .kind = Kind::kInt32},
    {.name = "sources", .kind = Kind::kStruct, .type = &kTrackSource, .max_count = 64},
    {.name = "v2v_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "trust_state", .kind = Kind::kInt8},
    {.name = "bridge_budget_s", .kind = Kind::kDouble},
    {.name = "latitude_rad", .kind = Kind::kDouble},
    {.name = "longitude_rad", .kind = Kind::kDouble},
    {.name = "bias_east_m", .kind = Kind::kDouble},
    {.name = "bias_north_m", .kind = Kind::kDouble},
    {.name = "events", .kind = Kind::kByte},
};
constexpr Layout kTrack = MakeLayout("track_t", kTrackFields);

constexpr Field kTrackListFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "revision", .kind = Kind::kInt32},
    {.name = "stale", .kind = Kind::kInt8},
    {.name = "ego_gnss_suspect", .kind = Kind::kInt8},
    {.name = "ego_x_odom_m", .kind = Kind::kDouble},
    {.name = "ego_y_odom_m", .kind = Kind::kDouble},
    {.name = "ego_yaw_odom_rad", .kind = Kind::kDouble},
    {.name = "num_sectors", .kind = Kind::kInt32},
    {.name = "sectors", .kind = Kind::kStruct, .type = &kSectorHealth, .max_count = 256},
    {.name = "num_tracks", .kind = Kind::kInt32},
    {.name = "tracks", .kind = Kind::kStruct, .type = &kTrack, .max_count = 8192},
};
constexpr Layout kTrackList = MakeLayout("track_list_t", kTrackListFields, 8 * 1024 * 1024);

constexpr Field kTruthSensorFields[] = {
    {.name = "sensor", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "detection_probability", .kind = Kind::kDouble},
    {.name = "visible_fraction", .kind = Kind::kDouble},
};
constexpr Layout kTruthSensor = MakeLayout("truth_sensor_t", kTruthSensorFields);

constexpr Field kTruthObjectFields[] = {
    {.name = "id", .kind = Kind::kInt64},
    {.name = "object_class", .kind = Kind::kInt8},
    {.name = "has_v2v", .kind = Kind::kInt8},
    {.name = "v2v_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "x_m", .kind = Kind::kDouble},
    {.name = "y_m", .kind = Kind::kDouble},
    {.name = "yaw_rad", .kind = Kind::kDouble},
    {.name = "speed_mps", .kind = Kind::kDouble},
    {.name = "yaw_rate_radps", .kind = Kind::kDouble},
    {.name = "accel_mps2", .kind = Kind::kDouble},
    {.name = "length_m", .kind = Kind::kDouble},
    {.name = "width_m", .kind = Kind::kDouble},
    {.name = "height_m", .kind = Kind::kDouble},
    {.name = "is_hidden", .kind = Kind::kInt8},
    {.name = "num_sensors", .kind = Kind::kInt32},
    {.name = "sensors", .kind = Kind::kStruct, .type = &kTruthSensor, .max_count = 64},
};
constexpr Layout kTruthObject = MakeLayout("truth_object_t", kTruthObjectFields);

constexpr Field kTruthBsmFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "sender_id", .kind = Kind::kByte, .fixed = 4},
    {.name = "vehicle_id", .kind = Kind::kInt64},
    {.name = "device_id", .kind = Kind::kInt64},
    {.name = "is_attacker", .kind = Kind::kInt8},
    {.name = "is_attack", .kind = Kind::kInt8},
    {.name = "attack", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "age_s", .kind = Kind::kDouble},
    {.name = "claimed_x_m", .kind = Kind::kDouble},
    {.name = "claimed_y_m", .kind = Kind::kDouble},
    {.name = "claimed_yaw_rad", .kind = Kind::kDouble},
    {.name = "claimed_speed_mps", .kind = Kind::kDouble},
    {.name = "claimed_accel_mps2", .kind = Kind::kDouble},
    {.name = "claimed_length_m", .kind = Kind::kDouble},
    {.name = "claimed_width_m", .kind = Kind::kDouble},
    {.name = "honest_x_m", .kind = Kind::kDouble},
    {.name = "honest_y_m", .kind = Kind::kDouble},
    {.name = "honest_yaw_rad", .kind = Kind::kDouble},
    {.name = "honest_speed_mps", .kind = Kind::kDouble},
    {.name = "honest_accel_mps2", .kind = Kind::kDouble},
    {.name = "honest_length_m", .kind = Kind::kDouble},
    {.name = "honest_width_m", .kind = Kind::kDouble},
};
constexpr Layout kTruthBsm = MakeLayout("truth_bsm_t", kTruthBsmFields, 1024);

constexpr Field kTruthListFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "origin_latitude_rad", .kind = Kind::kDouble},
    {.name = "origin_longitude_rad", .kind = Kind::kDouble},
    {.name = "ego_x_m", .kind = Kind::kDouble},
    {.name = "ego_y_m", .kind = Kind::kDouble},
    {.name = "ego_yaw_rad", .kind = Kind::kDouble},
    {.name = "ego_speed_mps", .kind = Kind::kDouble},
    {.name = "ego_yaw_rate_radps", .kind = Kind::kDouble},
    {.name = "ego_accel_mps2", .kind = Kind::kDouble},
    {.name = "num_objects", .kind = Kind::kInt32},
    {.name = "objects", .kind = Kind::kStruct, .type = &kTruthObject, .max_count = 4096},
};
constexpr Layout kTruthList = MakeLayout("truth_list_t", kTruthListFields, 8 * 1024 * 1024);

constexpr Field kPathPointFields[] = {
    {.name = "x_body_m", .kind = Kind::kDouble},
    {.name = "y_body_m", .kind = Kind::kDouble},
};
constexpr Layout kPathPoint = MakeLayout("path_point_t", kPathPointFields);

constexpr Field kEgoIntentFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "turn_signal", .kind = Kind::kInt8},
    {.name = "brake", .kind = Kind::kInt8},
    {.name = "accel_request_mps2", .kind = Kind::kDouble},
    {.name = "num_points", .kind = Kind::kInt32},
    {.name = "points", .kind = Kind::kStruct, .type = &kPathPoint, .max_count = 1024},
};
constexpr Layout kEgoIntent = MakeLayout("ego_intent_t", kEgoIntentFields, 32 * 1024);

constexpr Field kWarningFields[] = {
    {.name = "track_id", .kind = Kind::kInt64},
    {.name = "local_id", .kind = Kind::kInt64},
    {.name = "kind", .kind = Kind::kInt8},
    {.name = "level", .kind = Kind::kInt8},
    {.name = "side", .kind = Kind::kInt8},
    {.name = "source", .kind = Kind::kInt8},
    {.name = "visibility", .kind = Kind::kInt8},
    {.name = "basis", .kind = Kind::kInt8},
    {.name = "since_utime", .kind = Kind::kInt64},
    {.name = "conflict_probability", .kind = Kind::kDouble},
    {.name = "time_to_conflict_s", .kind = Kind::kDouble},
    {.name = "time_to_conflict_early_s", .kind = Kind::kDouble},
    {.name = "post_encroachment_s", .kind = Kind::kDouble},
    {.name = "required_decel_mps2", .kind = Kind::kDouble},
    {.name = "warn_before_s", .kind = Kind::kDouble},
    {.name = "urgent_before_s", .kind = Kind::kDouble},
    {.name = "conflict_x_body_m", .kind = Kind::kDouble},
    {.name = "conflict_y_body_m", .kind = Kind::kDouble},
    {.name = "x_body_m", .kind = Kind::kDouble},
    {.name = "y_body_m", .kind = Kind::kDouble},
    {.name = "speed_mps", .kind = Kind::kDouble},
    {.name = "existence", .kind = Kind::kDouble},
    {.name = "own_sensor_age_s", .kind = Kind::kDouble},
    {.name = "bridge_budget_s", .kind = Kind::kDouble},
};
constexpr Layout kWarning = MakeLayout("warning_t", kWarningFields);

constexpr Field kWarningListFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "seq", .kind = Kind::kInt64},
    {.name = "local_seq", .kind = Kind::kInt64},
    {.name = "priority_seq", .kind = Kind::kInt64},
    {.name = "available_kinds", .kind = Kind::kInt32},
    {.name = "unavailable_kinds", .kind = Kind::kInt32},
    {.name = "degraded", .kind = Kind::kInt32},
    {.name = "num_warnings", .kind = Kind::kInt32},
    {.name = "warnings", .kind = Kind::kStruct, .type = &kWarning, .max_count = 4096},
};
constexpr Layout kWarningList = MakeLayout("warning_list_t", kWarningListFields, 1024 * 1024);

}  // namespace

#define V2VOUCH_LAYOUT(Type, layout) \
  template <>                        \
  const Layout& LayoutOf<Type>() {   \
    return layout;                   \
  }
V2VOUCH_LAYOUT(bsm_t, kBsm)
V2VOUCH_LAYOUT(bsm_verdict_t, kBsmVerdict)
V2VOUCH_LAYOUT(calibration_parameter_t, kCalibrationParameter)
V2VOUCH_LAYOUT(calibration_t, kCalibration)
V2VOUCH_LAYOUT(camera_box_t, kCameraBox)
V2VOUCH_LAYOUT(camera_detections_t, kCameraDetections)
V2VOUCH_LAYOUT(camera_image_t, kCameraImage)
V2VOUCH_LAYOUT(count_t, kCount)
V2VOUCH_LAYOUT(gps_bias_t, kGpsBias)
V2VOUCH_LAYOUT(input_status_t, kInputStatus)
V2VOUCH_LAYOUT(stage_latency_t, kStageLatency)
V2VOUCH_LAYOUT(daemon_status_t, kDaemonStatus)
V2VOUCH_LAYOUT(ego_motion_t, kEgoMotion)
V2VOUCH_LAYOUT(evidence_t, kEvidence)
V2VOUCH_LAYOUT(gnss_fix_t, kGnssFix)
V2VOUCH_LAYOUT(mount_status_t, kMountStatus)
V2VOUCH_LAYOUT(notice_t, kNotice)
V2VOUCH_LAYOUT(obu_status_t, kObuStatus)
V2VOUCH_LAYOUT(misbehavior_report_t, kMisbehaviorReport)
V2VOUCH_LAYOUT(object_t, kObject)
V2VOUCH_LAYOUT(object_list_t, kObjectList)
V2VOUCH_LAYOUT(radar_detection_t, kRadarDetection)
V2VOUCH_LAYOUT(radar_scan_t, kRadarScan)
V2VOUCH_LAYOUT(refusal_t, kRefusal)
V2VOUCH_LAYOUT(sector_health_t, kSectorHealth)
V2VOUCH_LAYOUT(sender_bias_t, kSenderBias)
V2VOUCH_LAYOUT(text_t, kText)
V2VOUCH_LAYOUT(track_source_t, kTrackSource)
V2VOUCH_LAYOUT(track_t, kTrack)
V2VOUCH_LAYOUT(track_list_t, kTrackList)
V2VOUCH_LAYOUT(truth_sensor_t, kTruthSensor)
V2VOUCH_LAYOUT(truth_object_t, kTruthObject)
V2VOUCH_LAYOUT(truth_bsm_t, kTruthBsm)
V2VOUCH_LAYOUT(truth_list_t, kTruthList)
V2VOUCH_LAYOUT(ego_intent_t, kEgoIntent)
V2VOUCH_LAYOUT(path_point_t, kPathPoint)
V2VOUCH_LAYOUT(warning_t, kWarning)
V2VOUCH_LAYOUT(warning_list_t, kWarningList)
#undef V2VOUCH_LAYOUT

}  // namespace v2vouch::wire
