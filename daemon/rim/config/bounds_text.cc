// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/bounds_text.h"

#include <optional>

#include "daemon/rim/config/number_text.h"

namespace v2vouch::config {

bool AreKept(const Bounds& bounds, double value) {
  return (!bounds.above || value > *bounds.above) &&
         (!bounds.at_least || value >= *bounds.at_least) &&
         (!bounds.below || value < *bounds.below) && (!bounds.at_most || value <= *bounds.at_most);
}

std::string BoundsText(const Bounds& bounds) {
  std::string words;
  const auto add = [&words](const char* word, const std::optional<double>& bound) {
    if (!bound) return;
    words += words.empty() ? "must be " : ", ";
    words += std::string(word) + " " + NumberText(*bound);
  };
  add("above", bounds.above);
  add("at least", bounds.at_least);
  add("below", bounds.below);
  add("at most", bounds.at_most);
  return words;
}

}  // namespace v2vouch::config
