// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace v2vouch::campaign {

/// Attacks that are looked at together.
struct Family {
  std::string title;
  std::string about;
  std::vector<std::string> ids;
};

/// All families of the catalogue; ids that belong to none form a last one.
const std::vector<Family>& Families();

/// F1 per message that CaTCH reached against the attack most like `name` ("A6/random_20_70m"), with
/// parameters fitted per scenario: the best of the four scenarios of VeReMi NextGen (2026). Other
/// traffic, other ranges: a landmark.
std::optional<double> PublishedF1(const std::string& name);

}  // namespace v2vouch::campaign
