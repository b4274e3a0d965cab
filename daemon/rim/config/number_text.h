// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace v2vouch::config {

/// The shortest text that reads back as the same number.
std::string NumberText(double number);

/// The shortest number of degrees that reads back as the same angle, where one does: every angle
/// that came from degrees has one.
std::string DegreesText(double radians);

}  // namespace v2vouch::config
