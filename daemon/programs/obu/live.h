// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/obu/gateway/gateway_config.h"
#include "daemon/obu/security/trust_anchors.h"

namespace v2vouch::obu {

/// Receives, publishes BSMs and, once a second, OBU_STATUS, until a stop is asked for.
/// @return exit code: 1 where a socket cannot be opened.
int RunGateway(const GatewayConfig& config, TrustAnchors anchors);

}  // namespace v2vouch::obu
