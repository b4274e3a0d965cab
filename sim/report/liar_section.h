// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/report/story.h"

namespace v2vouch::evaluation {

/// The liars of a run: what was claimed, how far from anything real, the trust each id had over
/// time, and the verdicts. HTML; `liars.has_liar()`.
std::string LiarSection(const Evaluation& evaluation, const LiarFacts& liars);

}  // namespace v2vouch::evaluation
