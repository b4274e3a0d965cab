// SPDX-License-Identifier: Apache-2.0
// Messages that the daemon and the programs around it receive.
#include "daemon/rim/wire/layout_limits.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/camera_box_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/object_t.hpp"
#include "v2vouch/path_point_t.hpp"
#include "v2vouch/radar_detection_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::wire {
namespace {

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

}  // namespace

V2VOUCH_LAYOUT(bsm_t, kBsm)
V2VOUCH_LAYOUT(camera_box_t, kCameraBox)
V2VOUCH_LAYOUT(camera_detections_t, kCameraDetections)
V2VOUCH_LAYOUT(camera_image_t, kCameraImage)
V2VOUCH_LAYOUT(ego_motion_t, kEgoMotion)
V2VOUCH_LAYOUT(gnss_fix_t, kGnssFix)
V2VOUCH_LAYOUT(object_t, kObject)
V2VOUCH_LAYOUT(object_list_t, kObjectList)
V2VOUCH_LAYOUT(radar_detection_t, kRadarDetection)
V2VOUCH_LAYOUT(radar_scan_t, kRadarScan)
V2VOUCH_LAYOUT(path_point_t, kPathPoint)
V2VOUCH_LAYOUT(ego_intent_t, kEgoIntent)

}  // namespace v2vouch::wire
