// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// Every calibrated number that `config` runs on, by the names of calibration_file.h and in the
/// units of these: value in force, and what its calibration says of it. Verdict PRIOR and an
/// unknown std (NaN) where no calibration names it.
wire::CalibrationInForce CalibrationInForce(const DaemonConfig& config);

/// In few words, for the status: "configuration", or the file's name and how its checksum begins.
std::string CalibrationTitle(const DaemonConfig& config);

/// How many parameters of the calibration in force have this verdict.
int CountVerdicts(const DaemonConfig& config, CalibrationVerdict verdict);

}  // namespace v2vouch
