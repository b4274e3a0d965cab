// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/rim/warnings_wire/feed.h"
#include "daemon/warnings/warnings_config.h"

namespace v2vouch {

/// The car as warnings need it.
struct WarnVehicle {
  double length_m = 4.7;
  double width_m = 1.85;
  double centre_x_m = 1.4;  ///< Centre of the footprint, ahead of the rear axle.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("length_m", length_m, {.at_least = 0.5, .at_most = 30.0});
    a.Field("width_m", width_m, {.at_least = 0.3, .at_most = 5.0});
    a.Field("centre_x_m", centre_x_m, {.at_least = -15.0, .at_most = 15.0});
  }
};

/// A configuration file of v2vouch-warn. The defaults are the shipped vehicle.
struct WarnFile {
  WarnVehicle vehicle;
  wire::WarnChannels channels;
  warnings::WarningsConfig warnings;

  [[nodiscard]] warnings::EgoBody body() const {
    return {vehicle.length_m, vehicle.width_m, vehicle.centre_x_m};
  }
  template <class Archive>
  void Visit(Archive& a) {
    a.Field("vehicle", vehicle);
    a.Field("channels", channels);
    a.Field("warnings", warnings);
  }
};

/// "" = the defaults. @return false with every problem.
bool LoadWarnFile(const std::string& path, WarnFile& file, std::vector<std::string>& problems);
std::string PrintWarnFile(const WarnFile& file);

}  // namespace v2vouch
