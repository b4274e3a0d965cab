// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

namespace v2vouch {

/// The reference data (V2VOUCH_DATA, else ../shared/data beside the checkout). May be absent: tests
/// that need it say SKIPPED then.
inline std::filesystem::path DataFolder() {
  const char* const folder = std::getenv("V2VOUCH_DATA");
  return folder != nullptr ? folder : "../shared/data";
}

}  // namespace v2vouch
