// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <v2vouch/truth_list_t.hpp>
#include <vector>

#include "sim/sensors/camera.h"
#include "sim/sensors/objects.h"
#include "sim/sensors/radar.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// The TRUTH channel: every vehicle within 150 m of the ego, and what each sensor can know of it.
/// Hidden = no sensor could detect it in a look now: no ray reaches it, or it is outside every
/// field of view or range. A camera that sees a sliver below its detector's limits does not count.
class TruthWriter {
 public:
  TruthWriter(const World& world, std::uint64_t seed);

  void Write(const Snapshot& snapshot, std::int64_t seq, truth_list_t& truth);

 private:
  const World& world_;
  std::uint64_t seed_;
  std::vector<RadarSimulator> radars_;
  std::vector<CameraSimulator> cameras_;
  std::vector<ObjectSimulator> objects_;
  std::vector<std::string> names_;          ///< Of all sensors, as the next.
  std::vector<std::vector<Sight>> sights_;  ///< Per sensor: radars, cameras, sources of objects.
};

}  // namespace v2vouch::sim
