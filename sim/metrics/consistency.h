// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/metrics/scoring.h"

namespace v2vouch::evaluation {

/// Sets the 95 % band of `anees` and the number of independent samples behind it, from the pairs
/// whose truth is hidden (or not).
///
///     tau = 1 + 2 sum over k rho(k)         rho: autocorrelation of the nees, k in instants,
///     n   = max(samples / tau, 1)            summed up to the first that is not positive
///     band = [chi2(0.025), chi2(0.975)] of 2 floor(n) degrees of freedom, / floor(n)
///
/// rho is pooled over all stretches of instants in a row of one vehicle and one track, about the
/// mean of all of them, so that a track that is wrong for good counts as little more than one
/// sample. It is followed up to half of the longest stretch; vehicles are taken as independent of
/// each other.
/// Sources: Bar-Shalom, Li, Kirubarajan (2001), 5.4.2 (NEES test); Geyer, "Practical Markov chain
/// Monte Carlo", Statistical Science 1992 (truncation of the sum).
void SetBand(const std::vector<MatchedPair>& pairs, Sighting sighting, Anees& anees);

/// The value that a chi-square variable of 2 * `pairs` degrees of freedom stays below with
/// probability `p` in (0, 1). Exact (Erlang) up to 5000 pairs, normal beyond.
double ChiSquareOfPairs(double p, int pairs);

}  // namespace v2vouch::evaluation
