// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/programs/doctor/advice.h"

namespace v2vouch {

/// The way from here to an LCM bus and back: multicast route, interface, ttl, granted receive
/// buffer, port, and a message of our own that must come back (channel V2VOUCH_DOCTOR).
/// @param use what the bus is for, as it is named in the findings.
/// @return whether messages can be heard at all.
bool CheckNetwork(const std::string& url, const std::string& use, AdviceList& findings);

}  // namespace v2vouch
