// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/program/shipped_folder.h"

#include <cstdlib>
#include <system_error>

namespace v2vouch {

std::filesystem::path ShippedFolder(const std::string& name) {
  if (const char* share = std::getenv("V2VOUCH_SHARE"); share != nullptr && *share != '\0') {
    return std::filesystem::path(share) / name;
  }
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return self.parent_path().parent_path() / "share/v2vouch" / name;
}

}  // namespace v2vouch
