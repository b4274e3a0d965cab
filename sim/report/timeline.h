// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/behaviour/evaluation.h"

namespace v2vouch::evaluation {

/// Per vehicle which list holds it when; hidden and out-of-view stretches shaded, time beyond the
/// disc left blank. The vehicles nearest to the ego over the run, V2V first, at most `rows`.
std::string Timeline(const Evaluation& evaluation, std::size_t rows);

}  // namespace v2vouch::evaluation
