// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

namespace v2vouch {

/// The reference data (V2VOUCH_DATA, else ../shared/data beside the checkout). May be absent.
inline std::filesystem::path DataFolder() {
  const char* folder = std::getenv("V2VOUCH_DATA");
  return folder != nullptr ? folder : "../shared/data";
}

}  // namespace v2vouch
