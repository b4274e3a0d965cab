// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch {

struct TombstoneConfig {
  double memory_s = 10.0;  ///< After the penalised sender was last heard.
  double gate_m = 5.0;     ///< A newcomer this near to where the old claims would be now ...
  double gate_mps2 = 3.0;  ///< ... plus half of this t^2 ...
  double gate_mps = 4.0;   ///< ... that moves like them, inherits.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("memory_s", memory_s, {.at_least = 0.0, .at_most = 600.0});
    a.Field("gate_m", gate_m, {.above = 0.0, .at_most = 50.0});
    a.Field("gate_mps2", gate_mps2, {.at_least = 0.0, .at_most = 20.0});
    a.Field("gate_mps", gate_mps, {.above = 0.0, .at_most = 50.0});
  }
};

}  // namespace v2vouch
