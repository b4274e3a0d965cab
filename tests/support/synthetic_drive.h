// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"

namespace v2vouch::testing {

/// A car that drives east at constant speed among others that keep theirs: the smallest world that
/// exercises the whole pipeline. Inputs come in order of time, noise is seeded.
struct SyntheticCar {
  double x_m = 0.0;  ///< Centre at t = 0, east of the ego's start.
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  SenderId sender = 0;          ///< 0: no V2V.
  bool is_real = true;          ///< false: radio only, a ghost.
  double claim_offset_m = 0.0;  ///< Claimed this far north of the truth.
};

struct SyntheticDrive {
  double duration_s = 10.0;
  double ego_speed_mps = 8.0;
  double gnss_jump_at_s = -1.0;  ///< < 0: never. From then on fixes lie gnss_jump_m to the north.
  double gnss_jump_m = 50.0;
  std::uint64_t seed = 1;
  VehicleConfig vehicle;
  std::vector<SyntheticCar> cars;
};

/// All inputs of a drive, ordered by stamp. BSMs are stamped with their reception 0.1 s after the
/// content.
std::vector<Input> MakeInputs(const SyntheticDrive& drive);

/// What is received of a car `t` seconds after the start.
Bsm SpokenAt(const SyntheticCar& car, double t, int count, Random& random);

/// Time of the start of every synthetic drive.
Timestamp DriveStart();

}  // namespace v2vouch::testing
