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

std::string WhyNotShipped(const std::string& name) {
  const std::filesystem::path folder = ShippedFolder(name);
  std::error_code ignored;
  if (std::filesystem::is_directory(folder, ignored)) return "";
  const char* share = std::getenv("V2VOUCH_SHARE");
  const bool is_set = share != nullptr && *share != '\0';
  std::string text = "no shipped files: there is no folder " + folder.string();
  text += is_set ? ", which V2VOUCH_SHARE names"
                 : ". Programs look for share/v2vouch beside the folder they lie in";
  return text +
         ". Copy that folder along with the programs, install them (cmake --install, or the "
         "package), or let V2VOUCH_SHARE name the folder that holds " +
         name;
}

}  // namespace v2vouch
