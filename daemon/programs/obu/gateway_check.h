// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/obu/gateway/gateway_config.h"

namespace v2vouch::obu {

/// What is wrong beyond single values: framings, addresses, ports and channels named twice.
void CheckGatewayConfig(const GatewayConfig& config, std::vector<std::string>& problems);

}  // namespace v2vouch::obu
