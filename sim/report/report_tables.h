// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/behaviour/evaluation.h"

namespace v2vouch::evaluation {

/// The gates as tiles.
std::string GatesHtml(const Evaluation& evaluation);
/// The paper's table, the paper's method on this run (where given), ours, and the bound.
std::string ComparisonHtml(const Evaluation& evaluation, const Evaluation* paper);
/// Consistency, trajectories, identity, hidden vehicles, hold times.
std::string DetailsHtml(const Evaluation& evaluation);
/// What every figure means and what the bound assumes.
std::string DefinitionsHtml(const Evaluation& evaluation);

}  // namespace v2vouch::evaluation
