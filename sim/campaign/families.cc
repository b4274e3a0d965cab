// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/families.h"

#include <array>
#include <string_view>
#include <utility>

namespace v2vouch::campaign {

const std::vector<Family>& Families() {
  static const std::vector<Family> kFamilies = {
      {"Ghosts",
       "Cars that do not exist, in front of the ego or out of an occlusion.",
       {"A1", "A2", "A3", "A4"}},
      {"Wrong places", "Offsets, random places, jumps, mirrored lanes.", {"A5", "A6", "A8", "A24"}},
      {"Slow drift", "Away from the truth at a constant rate, speed and heading to match.", {"A7"}},
      {"Old content", "Replays and delays.", {"A9", "A10"}},
      {"Sybil", "Many ids from one device.", {"A11", "A12"}},
      {"Hijack", "Shadows a real car until it is believed, then leaves it.", {"A13", "A14", "A15"}},
      {"False motion",
       "Frozen, wrong speed, wrong heading, feigned braking.",
       {"A16", "A17", "A18", "A19"}},
      {"Identity", "New ids, other people's ids, on and off.", {"A20", "A23", "A26"}},
      {"Accuracy and size", "Claims to be inaccurate, or to be another size.", {"A21", "A25"}},
      {"Flood", "More messages than anybody may send.", {"A22"}},
      {"Not to be told from honesty",
       "GNSS spoofing of a whole area, and a bias as honest receivers have: nobody is to be "
       "accused.",
       {"A27", "A28"}}};
  return kFamilies;
}

std::optional<double> PublishedF1(const std::string& name) {
  constexpr std::array<std::pair<std::string_view, double>, 15> kBest = {{
      {"A5/offset_20_70m", 0.846},
      {"A6/random_20_70m", 0.962},
      {"A24/mirror", 0.192},
      {"A17/add_1_7mps", 0.637},
      {"A17/random_1_7mps", 0.808},
      {"A17/zero", 0.907},
      {"A17/frozen", 0.424},
      {"A18/180deg", 0.593},
      {"A10/delay_2_4s", 0.126},
      {"A16/sudden_stop", 0.177},
      {"A19/feigned_braking", 0.067},
      {"A19/stronger", 0.116},
      {"A22/4x", 0.502},
      {"A11/grid_5", 0.366},
      {"A9/victim", 0.385},
  }};
  for (const auto& [attack, f1] : kBest) {
    if (attack == name) return f1;
  }
  return std::nullopt;
}

}  // namespace v2vouch::campaign
