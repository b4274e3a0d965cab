// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/sensors/message.h"
#include "sim/world/scenario.h"

namespace v2vouch::sim {

/// What was received and what is true of it.
struct Received {
  bsm_t bsm;
  truth_bsm_t truth;
  Message message;
};

/// The radio side of a run alone, without radar and camera: all messages that arrive, each sender's
/// in order. Problems are test failures.
std::vector<Received> RadioRun(const Scenario& scenario, std::uint64_t seed,
                               std::vector<std::string>* notes = nullptr);

/// A campaign scenario with an overlay of the catalogue ("" = none) and six vehicles of traffic.
Scenario CampaignScenario(const std::string& name, const std::string& overlay);

}  // namespace v2vouch::sim
