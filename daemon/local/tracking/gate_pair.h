// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "daemon/local/tracking/tracker.h"

// Private to the tracker's files: what radar and camera measurements have in common.
namespace v2vouch {

/// Standard deviations of the coarse gate; the chi-square gate decides.
inline constexpr double kCoarseSigmas = 4.7;

/// Size of the space that clutter of a kind spreads over. That of a box has as many dimensions as
/// it has usable edges; radar measurements differ in none.
double Cells(const CameraMeasurement& z, const CameraLook& look);
inline double Cells(const RadarMeasurement&, const RadarLook&) { return 1.0; }

template <class Look, class Measurement>
void Tracker::GatePair(std::size_t track, std::size_t measurement, const Look& look,
                       const Measurement& raw) {
  const Measurement z = Given(track, raw);
  const auto likelihood = hidden_[track].filter.Evaluate(look, z, settings_);
  if (!likelihood) return;
  AddPair(track, measurement, *likelihood, std::log(Cells(raw, look) / Cells(z, look)));
}

}  // namespace v2vouch
