// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/common/data/finding.h"

namespace v2vouch {

/// What is to be done about a PRIORITY vehicle. Judgements return it and the recipe
/// (V2vPerception) does it, so that no vehicle ends behind its caller's back.
struct VehicleAction {
  enum class Kind : std::uint8_t {
    kGoOn,
    kEnd,    ///< It ends without blame.
    kBlame,  ///< `finding` is held against its sender, which may end it.
  };
  Kind kind = Kind::kGoOn;
  Finding finding{};

  static VehicleAction GoOn() { return {}; }
  static VehicleAction End() { return {Kind::kEnd, {}}; }
  static VehicleAction Blame(const Finding& finding) { return {Kind::kBlame, finding}; }
};

}  // namespace v2vouch
