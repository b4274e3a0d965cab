// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/message_parts.h"

#include <algorithm>

namespace v2vouch::wire {
namespace {

constexpr double kScoreRounding = 0.01;

}  // namespace

double Score(double score, std::string_view field, std::string_view percent_field,
             FieldJudge& judge) {
  if (std::isnan(score) || score == 0.0) return 1.0;
  if (score > 0.0 && score <= 1.0 + kScoreRounding) return std::min(score, 1.0);
  if (score > 1.0 && score <= 100.0) {
    judge.Unused(percent_field);
    return score / 100.0;
  }
  judge.Unused(field);
  return 1.0;
}

std::optional<ObjectClass> Class(const std::string& name, std::string_view field,
                                 RefusalTally& dropped) {
  const NamedClass named = MeaningOf(name);
  if (!named.is_known || !named.is_road_user) {
    dropped.AddNamed({named.is_road_user ? Reason::kFieldUnused : Reason::kOutOfRange, field},
                     Printable(name));
    if (!named.is_road_user) return std::nullopt;
  }
  return named.object_class;
}

}  // namespace v2vouch::wire
