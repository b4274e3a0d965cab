// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/run_log/scene_specs.h"
#include "sim/run_log/truth.h"

namespace v2vouch::evaluation {

/// How a vehicle can be seen. Values of track_t.
enum class Sighting {
  kVisible = 0,
  kHidden = 1,     ///< Within a sensor's range and field of view, but something is in between.
  kOutOfView = 2,  ///< Within none.
};
const char* SightingName(Sighting sighting);  ///< "visible", "hidden", "out of view".

/// What is true of a vehicle with this motion: visible where TRUTH says so; else hidden where its
/// centre is inside some sensor's field of view and range; else out of view.
Sighting TrueSighting(const TruthSample& sample, const PlanarMotion& motion,
                      const Pose<World, Body>& X_WB, const SceneSpecs& specs);

/// A look that is at least this likely to detect is seeing.
inline constexpr double kSeeing = 0.5;

/// The truth's own detection probability for one sensor of the scenario, 0..1. Logs name a sensor
/// by its channel or by its bare name; a bare name shared by a radar and a camera stands for the
/// radar first and the camera last.
double DetectionProbability(const TruthSample& sample, const SensorSpec& sensor);

/// Whether as many kinds of sensors see it (`kSeeing` each) as KindsThatCheck() asks for.
bool IsSeenByEnough(const TruthSample& sample, const SceneSpecs& specs);

}  // namespace v2vouch::evaluation
