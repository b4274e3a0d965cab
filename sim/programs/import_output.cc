// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/import_output.h"

#include <cstdint>
#include <cstdio>
#include <map>

#include "daemon/rim/io/event_log.h"

namespace v2vouch::sim {

int ImportFailed(const std::string& why) {
  std::fprintf(stderr, "v2vouch-import: %s\n", why.c_str());
  return 1;
}

void TellFigures(const nlohmann::ordered_json& figures, bool as_json) {
  if (as_json) {
    std::printf("%s\n", figures.dump().c_str());
    return;
  }
  for (const auto& [name, value] : figures.items()) {
    std::printf("%-16s %s\n", name.c_str(), value.dump().c_str());
  }
}

int WriteImportedLog(const std::string& out, std::span<const std::string> inputs,
                     const std::vector<ImportedEvent>& events,
                     const nlohmann::ordered_json& figures, bool as_json) {
  std::string error;
  const auto writer = LogWriter::Create(out, error, inputs);
  if (writer == nullptr) return ImportFailed(error);
  std::map<std::string, std::int64_t> channels;
  for (const ImportedEvent& event : events) {
    writer->Write(event.received, event.channel, event.bytes);
    ++channels[event.channel];
  }
  if (!writer->Close(error)) return ImportFailed(error);
  nlohmann::ordered_json all;
  all["log"] = out;
  for (const auto& [name, value] : figures.items()) all[name] = value;
  all["events"] = events.size();
  all["seconds"] = ToSeconds(events.back().received - events.front().received);
  all["channels"] = channels;
  TellFigures(all, as_json);
  return 0;
}

}  // namespace v2vouch::sim
