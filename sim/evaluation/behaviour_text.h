// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/evaluation/behaviour.h"

namespace v2vouch::evaluation {

/// Behaviour in the three forms that v2vouch-eval gives: JSON object, lines for the terminal, HTML
/// tables.
nlohmann::ordered_json BehaviourJson(const Behaviour& behaviour);
std::string BehaviourTable(const Behaviour& behaviour);
std::string BehaviourHtml(const Behaviour& behaviour);

/// An ANEES with its band: "2.31 (band 1.62 to 2.42, 38 independent of 1200)"; "none" without
/// samples.
std::string AneesText(const Anees& anees);

/// Six significant digits: enough to compare, and the same bytes from run to run.
double Rounded(double value);

}  // namespace v2vouch::evaluation
