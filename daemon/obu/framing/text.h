// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace v2vouch::obu {

/// The payload of an RSU 4.1 message file ("Version=0.7", "Payload=0014..."); nullopt where `text`
/// is none.
std::optional<std::string_view> PayloadOfRsuText(std::string_view text);

}  // namespace v2vouch::obu
