// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/stored_config.h"

#include "daemon/rim/config/yaml_reader.h"

namespace v2vouch::view {
namespace {

struct LcmSection {
  wire::ChannelNames channels;
  template <class Archive>
  void Visit(Archive& a) {
    a.Field("channels", channels);
  }
};

struct File {
  VehicleConfig vehicle;
  LcmSection lcm;
  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle);
    a.Field("lcm", lcm);
  }
};

}  // namespace

StoredConfig ReadStoredConfig(std::string_view text) {
  File file;
  std::vector<std::string> ignored;
  config::Parse(text, "V2VOUCH_CONFIG", file, ignored);
  return {std::move(file.vehicle), std::move(file.lcm.channels)};
}

}  // namespace v2vouch::view
