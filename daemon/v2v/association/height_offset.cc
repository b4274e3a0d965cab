// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/association/height_offset.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {

HeightOffset::Votes HeightOffset::VotesFor(double offset_m,
                                           std::span<const HeightWitness> witnesses) {
  Votes votes;
  for (const HeightWitness& witness : witnesses) {
    if (witness.agreed_m < kLeastWay_m) continue;
    if (std::abs(witness.difference_m - offset_m) > std::max(kSame_m, witness.slack_m)) continue;
    ++votes.agreed;
    votes.mean_m += (witness.difference_m - votes.mean_m) / votes.agreed;
    votes.second_m = std::max(votes.second_m, std::min(votes.longest_m, witness.agreed_m));
    votes.longest_m = std::max(votes.longest_m, witness.agreed_m);
  }
  return votes;
}

bool HeightOffset::IsCommonToAll(double offset_m, std::span<const HeightWitness> witnesses) {
  return std::ranges::all_of(witnesses, [&](const HeightWitness& witness) {
    return std::abs(witness.difference_m - offset_m) <= kSame_m + witness.slack_m;
  });
}

bool HeightOffset::IsShown(const Votes& votes, std::span<const HeightWitness> witnesses) {
  if (std::abs(votes.mean_m) < kBridge_m) return votes.second_m >= kBridgeWay_m;
  if (votes.agreed >= 2) return true;
  const double way_m = witnesses.size() > 1 ? kLeastWay_m : kAloneWay_m;
  return votes.longest_m >= way_m && IsCommonToAll(votes.mean_m, witnesses);
}

bool HeightOffset::Judge(std::span<const HeightWitness> witnesses) {
  const bool is_other = std::ranges::none_of(witnesses, [&](const HeightWitness& witness) {
    return std::abs(witness.difference_m - offset_m_) <= witness.slack_m;
  });
  const double first = witnesses.empty() ? 0.0 : witnesses.front().difference_m;
  const bool is_unexplained = !witnesses.empty() && is_other && IsCommonToAll(first, witnesses);
  unexplained_m_ = is_unexplained ? std::optional(first) : std::nullopt;
  return Decide(witnesses);
}

bool HeightOffset::Decide(std::span<const HeightWitness> witnesses) {
  const Votes none = VotesFor(0.0, witnesses);
  const Votes present = VotesFor(offset_m_, witnesses);
  if (offset_m_ != 0.0 && none.agreed > 0 && none.agreed >= present.agreed) {
    offset_m_ = 0.0;
    return true;
  }
  // The offset that most agree on; the first of them, in the order given, where several do.
  Votes best;
  for (const HeightWitness& witness : witnesses) {
    if (witness.agreed_m < kLeastWay_m) continue;
    const Votes votes = VotesFor(witness.difference_m, witnesses);
    if (votes.agreed > best.agreed) best = votes;
  }
  if (best.agreed <= std::max(present.agreed, none.agreed)) return false;
  const double offset = best.mean_m;
  if (!IsShown(best, witnesses)) return false;
  offset_m_ = offset;
  return true;
}

}  // namespace v2vouch
