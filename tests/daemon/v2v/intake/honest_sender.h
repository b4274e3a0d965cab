// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// How an honest unit errs. All of it can be told from real logs; none of it is a lie.
struct HonestErrors {
  double bias_sigma_m = 1.0;  ///< Per axis, Gauss-Markov.
  double bias_time_s = 100.0;
  double white_m = 0.3;
  double accuracy_m = 1.5;  ///< As reported.
  double latency_s = 0.07;
  double latency_spread_s = 0.13;  ///< Uniform on top.
  double stale_s = 0.0;            ///< Places are older than their stamps by up to this, uniform.
  double rate_hz = 10.0;
  double loss = 0.1;
  double gap_s = 0.0;             ///< A silence of this length every 30 s.
  double pair_share = 0.0;        ///< Messages followed by another 50 ms later.
  double speed_sigma_mps = 0.28;  ///< SAE J2945/1, 1 sigma; half of it lasting.
  double course_sigma_deg = 2.0;
  double step_m = 0.0;             ///< GNSS re-converges by this every 30 s.
  double burst_m = 0.0;            ///< Off by this for 5 s of every 30 s.
  double burst_rise_s = 0.0;       ///< Rises and falls within this time.
  bool is_burst_reported = false;  ///< The reported accuracy follows.
  bool is_moving = true;
};

/// What is received of one honest vehicle, in order of reception: town driving drawn from `seed`
/// with stops, hard braking (8 m/s^2), turns, U-turns and reversing. A standing unit's place
/// wanders and its course is held.
std::vector<Bsm> HonestMessages(const HonestErrors& errors, double duration_s, std::uint64_t seed);

}  // namespace v2vouch
