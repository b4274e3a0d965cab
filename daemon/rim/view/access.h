// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::view {

/// Who may talk to the server. A browser on the same machine is itself a loopback client, so that
/// any web page could ask: its requests bear a Host or an Origin that is not ours, and no token.
struct AccessRules {
  std::uint16_t port = 0;
  std::string token;                 ///< Empty: none is asked for.
  std::vector<std::string> hosts;    ///< Further host names, without port.
  std::vector<std::string> origins;  ///< Further origins, whole: https://app.example
};

/// Whether a Host header names this server: localhost, a literal address of 127.0.0.0/8 or [::1],
/// or an allowed name; with our port. Never by prefix: 127.0.0.1.attacker.example is refused.
bool IsHostAllowed(const AccessRules& rules, std::string_view host);

/// Whether a request with this Origin header ("" = none: no browser) may be answered: exactly
/// http://HOST of the same, allowed request, or an allowed origin.
bool IsOriginAllowed(const AccessRules& rules, std::string_view host, std::string_view origin);

/// Whether the token is in the request: query `?t=TOKEN` or sub-protocol `v2vouch.token.TOKEN`.
bool HasToken(const AccessRules& rules, std::string_view target, std::string_view protocols);

/// The sub-protocol to speak: v2vouch.view.v1 (our page), foxglove.sdk.v1 or
/// foxglove.websocket.v1, whichever is offered first in this order; nullopt where none is.
std::optional<std::string> ChooseProtocol(std::string_view offered);

inline constexpr std::string_view kPageProtocol = "v2vouch.view.v1";

}  // namespace v2vouch::view
