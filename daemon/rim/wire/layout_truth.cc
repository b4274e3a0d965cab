// SPDX-License-Identifier: Apache-2.0
// What the simulator publishes of the truth.
#include "daemon/rim/wire/layout_limits.h"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/truth_object_t.hpp"
#include "v2vouch/truth_sensor_t.hpp"

namespace v2vouch::wire {
namespace {

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

}  // namespace

V2VOUCH_LAYOUT(truth_sensor_t, kTruthSensor)
V2VOUCH_LAYOUT(truth_object_t, kTruthObject)
V2VOUCH_LAYOUT(truth_bsm_t, kTruthBsm)
V2VOUCH_LAYOUT(truth_list_t, kTruthList)

}  // namespace v2vouch::wire
