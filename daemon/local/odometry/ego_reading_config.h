// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"

namespace v2vouch {

/// Settings of how EGO_MOTION is read.
struct EgoReadingConfig {
  bool learn_gyro_offset = true;  ///< At standstill; a standing car does not turn.
  bool check_speed = true;  ///< Against gear and the Doppler of the standing world; correct it.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("learn_gyro_offset", learn_gyro_offset);
    a.Field("check_speed", check_speed);
  }
};

}  // namespace v2vouch
