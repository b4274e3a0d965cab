// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "daemon/v2v/trust/sender_trust.h"

/// One sender under made-up evidence.
namespace v2vouch {

inline const TrustConfig kConfig;

inline Timestamp At(double time_s) { return FromMicros(1'000'000'000) + FromSeconds(time_s); }

inline ValidationEvidence Good() {
  return {.co_observations = 20,
          .span_s = 2.0,
          .is_nis_consistent = true,
          .margin = 10.0,
          .is_assigned = true,
          .are_sensors_sure = true};
}

inline SenderTrust Candidate() {
  SenderTrust trust;
  for (int i = 0; i < 3; ++i) trust.OnMessage(At(0.1 * i), true, kConfig);
  return trust;
}

inline SenderTrust Validated() {
  SenderTrust trust = Candidate();
  EXPECT_TRUE(trust.TryValidate(Good(), kConfig));
  return trust;
}

// Feeds residuals at 10 Hz from `from_s` on; @return when a verdict came, or NaN.
inline double RunUntilVerdict(SenderTrust& trust, double from_s, double for_s,
                              const std::function<CoObservation(double)>& residual,
                              Verdict wanted) {
  for (int i = 0; i < static_cast<int>(for_s * 10.0); ++i) {
    const double t = 0.1 * i;
    CoObservation observation = residual(t);
    observation.stamp = At(from_s + t);
    trust.OnMessage(observation.stamp, true, kConfig);
    trust.OnCoObservation(observation, true, kConfig);
    const auto verdict = trust.TakeVerdict();
    if (verdict && verdict->verdict == wanted) return t;
  }
  return std::nan("");
}

inline CoObservation Residual(double x_m, double y_m) {
  CoObservation observation;
  observation.residual_O = {x_m, y_m};
  observation.track_speed_mps = 10.0;
  return observation;
}

// Agrees with the sensors at 10 Hz; @return for how long until no longer SUSPECT, or NaN.
inline double AgreeUntilClean(SenderTrust& trust, double from_s) {
  for (int i = 0; i < 1200; ++i) {
    CoObservation observation = Residual(0.0, 0.0);
    observation.stamp = At(from_s + 0.1 * i);
    trust.OnMessage(observation.stamp, true, kConfig);
    if (trust.state() != TrustState::kSuspect) return 0.1 * i;
    trust.OnCoObservation(observation, true, kConfig);
  }
  return std::nan("");
}

}  // namespace v2vouch
