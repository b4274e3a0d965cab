// SPDX-License-Identifier: Apache-2.0
#include "sim/world/actor.h"

namespace v2vouch::sim {

Actor MakeDriven(const VehicleSpec& spec, const Path& path, double duration_s) {
  Actor actor;
  actor.id = spec.id;
  actor.object_class = spec.object_class;
  actor.size = UsualSize(spec.object_class);
  if (spec.length_m > 0.0) actor.size.length_m = spec.length_m;
  if (spec.width_m > 0.0) actor.size.width_m = spec.width_m;
  if (spec.height_m > 0.0) actor.size.height_m = spec.height_m;
  actor.has_v2v = spec.v2v;
  actor.sender = spec.sender;
  actor.drive = spec.drive;
  actor.trajectory = Trajectory::Drive(path, spec.drive, actor.size.length_m,
                                       kCentreAheadOfAxle * actor.size.length_m, duration_s);
  return actor;
}

}  // namespace v2vouch::sim
