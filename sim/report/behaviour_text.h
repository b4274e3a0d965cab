// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "sim/behaviour/evaluation.h"

namespace v2vouch::evaluation {

/// Behaviour in the three forms that v2vouch-eval gives: JSON object, lines for the terminal, HTML
/// tables.
nlohmann::ordered_json BehaviourJson(const Behaviour& behaviour);
std::string BehaviourTable(const Behaviour& behaviour);
std::string BehaviourHtml(const Behaviour& behaviour);

/// An ANEES with its band: "2.31 (band 1.62 to 2.42, 38 independent of 1200)"; "none" without
/// samples.
std::string AneesText(const Anees& anees);

/// "0.41 m RMS, 1.20 m at most, over 12.0 vehicle-seconds (the bound could keep 14.0)".
std::string UnseenText(const UnseenError& error);

/// "12.5 %"; "none" where there is no value.
std::string WithUnit(double value, int digits, const char* unit);

/// Six significant digits: enough to compare, and the same bytes from run to run.
double Rounded(double value);

/// One line of text, as printf makes it.
std::string Line(const char* format, auto... values) {
  char text[320];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace v2vouch::evaluation
