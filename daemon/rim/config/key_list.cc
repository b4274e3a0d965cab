// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/key_list.h"

namespace v2vouch::config {

std::string KeyLister::AfterColon(const std::string& line) {
  const std::size_t colon = line.find(": ");
  if (colon == std::string::npos) return "";
  std::string value = line.substr(colon + 2);
  while (!value.empty() && value.back() == '\n') value.pop_back();
  return value;
}

}  // namespace v2vouch::config
