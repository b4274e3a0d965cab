// SPDX-License-Identifier: Apache-2.0
// What programs publish of themselves.
#include "daemon/rim/wire/layout_limits.h"
#include "v2vouch/calibration_parameter_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/count_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/gps_bias_t.hpp"
#include "v2vouch/input_status_t.hpp"
#include "v2vouch/mount_status_t.hpp"
#include "v2vouch/notice_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/refusal_t.hpp"
#include "v2vouch/sender_bias_t.hpp"
#include "v2vouch/stage_latency_t.hpp"
#include "v2vouch/text_t.hpp"

namespace v2vouch::wire {
namespace {

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

constexpr Field kTextFields[] = {
    {.name = "utime", .kind = Kind::kInt64},
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "text", .kind = Kind::kString, .max_length = kMaxTextBytes},
};
constexpr Layout kText = MakeLayout("text_t", kTextFields, kMaxTextBytes + 1024);

}  // namespace

V2VOUCH_LAYOUT(calibration_parameter_t, kCalibrationParameter)
V2VOUCH_LAYOUT(calibration_t, kCalibration)
V2VOUCH_LAYOUT(count_t, kCount)
V2VOUCH_LAYOUT(input_status_t, kInputStatus)
V2VOUCH_LAYOUT(stage_latency_t, kStageLatency)
V2VOUCH_LAYOUT(sender_bias_t, kSenderBias)
V2VOUCH_LAYOUT(gps_bias_t, kGpsBias)
V2VOUCH_LAYOUT(mount_status_t, kMountStatus)
V2VOUCH_LAYOUT(notice_t, kNotice)
V2VOUCH_LAYOUT(obu_status_t, kObuStatus)
V2VOUCH_LAYOUT(refusal_t, kRefusal)
V2VOUCH_LAYOUT(daemon_status_t, kDaemonStatus)
V2VOUCH_LAYOUT(text_t, kText)

}  // namespace v2vouch::wire
