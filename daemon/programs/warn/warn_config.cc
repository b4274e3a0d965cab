// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/warn/warn_config.h"

#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"

namespace v2vouch {

bool LoadWarnFile(const std::string& path, WarnFile& file, std::vector<std::string>& problems) {
  return path.empty() || config::Load(path, file, problems);
}

std::string PrintWarnFile(const WarnFile& file) { return config::Print(file); }

}  // namespace v2vouch
