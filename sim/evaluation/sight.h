// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/evaluation/scene_specs.h"
#include "sim/evaluation/truth.h"

namespace v2vouch::evaluation {

/// A look that is at least this likely to detect is seeing.
inline constexpr double kSeeing = 0.5;

/// The truth's own detection probability for one sensor of the scenario, 0..1. Logs name a sensor
/// by its channel or by its bare name; a bare name shared by a radar and a camera stands for the
/// radar first and the camera last.
double DetectionProbability(const TruthSample& sample, const SensorSpec& sensor);

/// Whether a radar and a camera see it (`kSeeing` each).
bool IsSeenByBoth(const TruthSample& sample, const SceneSpecs& specs);

}  // namespace v2vouch::evaluation
