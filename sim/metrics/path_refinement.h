// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sim/metrics/trajectory_problem.h"

namespace v2vouch::evaluation::tgospa {

/// Improves a path truth by truth: with the others' matchings fixed, one truth's best sequence over
/// the tracks they leave free is a small shortest path. The beam looks one step ahead only; this
/// looks over the whole run. Never makes the path dearer.
void Refine(const Problem& problem, const Cluster& cluster, std::vector<Matching>& path);

}  // namespace v2vouch::evaluation::tgospa
