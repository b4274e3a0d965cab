// SPDX-License-Identifier: Apache-2.0
// What the lists of a log hold, truth or not.
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "sim/behaviour/evaluation.h"
#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

struct ListCounts {
  std::size_t lists = 0;
  std::size_t stale = 0;
  std::size_t distinct_tracks = 0;
  double tracks_mean = kNoValue;
  double longest_s = kNoValue;
  double seconds = kNoValue;
};

ListCounts CountList(const std::vector<ReceivedList>& lists) {
  ListCounts counts;
  counts.lists = lists.size();
  std::map<std::int64_t, std::pair<Timestamp, Timestamp>> lives;
  double tracks = 0.0;
  for (const ReceivedList& list : lists) {
    counts.stale += list.is_stale ? 1 : 0;
    tracks += static_cast<double>(list.tracks.size());
    for (const ListedTrack& track : list.tracks) {
      const auto [life, is_new] = lives.try_emplace(track.id, list.stamp, list.stamp);
      life->second.second = list.stamp;
    }
  }
  counts.distinct_tracks = lives.size();
  for (const auto& [id, life] : lives) {
    counts.longest_s = std::fmax(counts.longest_s, ToSeconds(life.second - life.first));
  }
  if (!lists.empty()) {
    counts.tracks_mean = tracks / static_cast<double>(lists.size());
    counts.seconds = ToSeconds(lists.back().stamp - lists.front().stamp);
  }
  return counts;
}

}  // namespace

std::string ListSummaryJson(const RunLog& log) {
  Json json;
  json["has_truth"] = !log.truth.empty();
  json["log_seconds"] = Rounded(log.log_seconds);
  json["events"] = log.events;
  for (const ListKind kind : kLists) {
    const ListCounts counts = CountList(log.lists[Index(kind)]);
    json["lists"][ListKey(kind)] = {{"lists", counts.lists},
                                    {"stale", counts.stale},
                                    {"seconds", Rounded(counts.seconds)},
                                    {"tracks_mean", Rounded(counts.tracks_mean)},
                                    {"distinct_tracks", counts.distinct_tracks},
                                    {"longest_track_s", Rounded(counts.longest_s)}};
  }
  return json.dump(1) + "\n";
}

std::string ListSummary(const RunLog& log) {
  std::string out =
      Line("%.1f s of log, %lld events%s\n", log.log_seconds, static_cast<long long>(log.events),
           log.truth.empty() ? "; no truth, so nothing can be judged" : "");
  out += "  list       lists  stale  seconds  tracks at a time  distinct  longest [s]\n";
  for (const ListKind kind : kLists) {
    const ListCounts counts = CountList(log.lists[Index(kind)]);
    out +=
        Line("  %-8s %7zu %6zu %8s %17s %9zu %12s\n", ListTitle(kind), counts.lists, counts.stale,
             Fixed(counts.seconds, 1).c_str(), Fixed(counts.tracks_mean, 2).c_str(),
             counts.distinct_tracks, Fixed(counts.longest_s, 1).c_str());
  }
  return out;
}

}  // namespace v2vouch::evaluation
