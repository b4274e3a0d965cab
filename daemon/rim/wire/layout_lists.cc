// SPDX-License-Identifier: Apache-2.0
// What is published of vehicles and senders.
#include "daemon/rim/wire/layout_limits.h"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/evidence_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/sector_health_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/track_source_t.hpp"
#include "v2vouch/track_t.hpp"
#include "v2vouch/warning_list_t.hpp"
#include "v2vouch/warning_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr Field kEvidenceFields[] = {
    {.name = "name", .kind = Kind::kString, .max_length = kMaxNameBytes},
    {.name = "value", .kind = Kind::kDouble},
};
constexpr Layout kEvidence = MakeLayout("evidence_t", kEvidenceFields);

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

constexpr Field kSectorHealthFields[] = {
    {.name = "from_rad", .kind = Kind::kDouble},
    {.name = "to_rad", .kind = Kind::kDouble},
    {.name = "range_m", .kind = Kind::kDouble},
    {.name = "state", .kind = Kind::kInt8},
};
constexpr Layout kSectorHealth = MakeLayout("sector_health_t", kSectorHealthFields);

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

V2VOUCH_LAYOUT(evidence_t, kEvidence)
V2VOUCH_LAYOUT(misbehavior_report_t, kMisbehaviorReport)
V2VOUCH_LAYOUT(bsm_verdict_t, kBsmVerdict)
V2VOUCH_LAYOUT(sector_health_t, kSectorHealth)
V2VOUCH_LAYOUT(track_source_t, kTrackSource)
V2VOUCH_LAYOUT(track_t, kTrack)
V2VOUCH_LAYOUT(track_list_t, kTrackList)
V2VOUCH_LAYOUT(warning_t, kWarning)
V2VOUCH_LAYOUT(warning_list_t, kWarningList)

}  // namespace v2vouch::wire
