// SPDX-License-Identifier: Apache-2.0
// The three lists of a run.
#include <algorithm>
#include <array>
#include <map>

#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {

const char* ListKey(ListKind kind) {
  constexpr std::array kKeys = {"local", "v2v", "priority"};
  return kKeys[Index(kind)];
}

const char* ListTitle(ListKind kind) {
  constexpr std::array kTitles = {"LOCAL", "V2V", "PRIORITY"};
  return kTitles[Index(kind)];
}

void JoinLocal(const RunLog& other, int run, RunLog& log) {
  std::map<Timestamp, const ReceivedList*> last;  // Correction of each stamp.
  const std::size_t local = Index(ListKind::kLocal);
  for (const ReceivedList& list : other.lists[local]) last[list.stamp] = &list;
  for (ReceivedList& list : log.lists[local]) {
    const auto found = last.find(list.stamp);
    if (found == last.end()) continue;
    for (ListedTrack track : found->second->tracks) {
      constexpr std::int64_t kSpread = 0x9E37'79B9'7F4A;
      track.id ^= kSpread * run;
      list.tracks.push_back(track);
    }
  }
}

const ReceivedList* NewestBy(const std::vector<ReceivedList>& lists, Timestamp t) {
  const auto after = std::upper_bound(
      lists.begin(), lists.end(), t,
      [](Timestamp value, const ReceivedList& list) { return value < list.received; });
  return after == lists.begin() ? nullptr : &*(after - 1);
}

}  // namespace v2vouch::evaluation
