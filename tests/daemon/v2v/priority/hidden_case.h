// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace v2vouch {

/// What the sensors report of the vehicle.
enum class HiddenCaseTarget {
  kPoint,          ///< Its centre: the extent is known and plays no part.
  kExtentKnown,    ///< Reflections on its faces, a box in the picture; the filter knows its size.
  kExtentUnknown,  ///< The same; the filter takes LOCAL's estimate of the size.
};

/// The stated case of a validated vehicle: seen for 6 s, then hidden for 4 s while its sender goes
/// on talking at 10 Hz. Claims: white noise 1.0 m, bias 1.5 m per axis, alignment's heading off by
/// 0.3 deg, claimed speed and direction off by 0.1 m/s and 0.7 deg for good (sigmas; drawn per
/// run). An oncoming car 90 m off that brakes, goes on and sways; none of that is the filter's own
/// model. Radar 20 Hz: 0.25 m, 0.5 deg, 0.1 m/s; for an extended car a camera at 10 Hz too, and
/// LOCAL is the tracker itself.
struct HiddenCase {
  HiddenCaseTarget target = HiddenCaseTarget::kPoint;
  int runs = 50;
  bool has_claims_while_hidden = true;
  double correlated_m = 0.0;  ///< Gauss-Markov part of the claims' error (30 s), sigma per axis.
  std::uint64_t seed = 20240611;
};

/// Position errors over runs and instants.
struct HiddenCaseFigures {
  double squared = 0.0;
  double nees = 0.0;
  int count = 0;
  [[nodiscard]] double rms() const { return std::sqrt(squared / count); }
  [[nodiscard]] double anees() const { return nees / count; }  ///< 2 is ideal.
};

struct HiddenCaseResult {
  HiddenCaseFigures seen;        ///< From the third second on.
  HiddenCaseFigures hidden;      ///< The four seconds.
  HiddenCaseFigures at_end;      ///< Their last instant.
  HiddenCaseFigures local_seen;  ///< LOCAL beside `seen`: the same without any claim.
  int lost = 0;                  ///< Runs without a LOCAL track to start from, or not healthy.
};

HiddenCaseResult RunHiddenCase(const HiddenCase& settings);

}  // namespace v2vouch
