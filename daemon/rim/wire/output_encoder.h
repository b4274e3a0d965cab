// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/data/outputs.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/rim/wire/status.h"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::wire {

/// Our outputs -> bytes of an LCM message, into `bytes`, whose storage is reused.

/// State in the odometry frame and in the ego's body frame at the list's time: positions from the
/// rear axle, yaw against the ego's, speeds over ground. The body covariance is the same one
/// turned:
///     P_B = J P_O J^T,  J = diag(R_BO, 1, 1, 1, 1)
/// The ego's own pose counts as known: tracks live in the frame it dead-reckons. `vehicle` names
/// the sensors that have measured them.
track_list_t ToWire(const TrackList& list, const VehicleConfig& vehicle);

void EncodeList(const TrackList& list, const VehicleConfig& vehicle,
                std::vector<std::uint8_t>& bytes);
void EncodeReport(const MisbehaviorReport& report, std::vector<std::uint8_t>& bytes);
void EncodeVerdict(const BsmVerdict& verdict, std::vector<std::uint8_t>& bytes);
/// As the camera `camera` would have told them itself: its clock offset taken off the stamp again.
void EncodeDetections(const CameraDetections& detections, const CameraConfig& camera,
                      std::vector<std::uint8_t>& bytes);
void EncodeCalibration(const CalibrationInForce& calibration, std::vector<std::uint8_t>& bytes);
/// NULs in `text` are left out, and what is longer than a text_t may be is cut.
void EncodeText(Timestamp stamp, const std::string& name, const std::string& text,
                std::vector<std::uint8_t>& bytes);

}  // namespace v2vouch::wire
