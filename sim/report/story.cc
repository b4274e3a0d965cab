// SPDX-License-Identifier: Apache-2.0
#include "sim/report/story.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <set>

#include "sim/plot/svg.h"
#include "sim/report/moments.h"

namespace v2vouch::evaluation {
namespace {

std::string Seconds(double s) { return Number(s, 1) + " s"; }

// What one list made of a vehicle during a stretch: seconds until it was first not held (negative:
// held all along), the share held, the largest error.
struct Kept {
  bool was_held = false;  // Just before, or when it began.
  double lost_after_s = -1.0;
  double share = 0.0;
  double max_error_m = 0.0;
};

Kept KeptDuring(const Evaluation& evaluation, ListKind kind, std::size_t object,
                const Interval& when) {
  std::map<std::size_t, double> errors;
  for (const MatchedPair& pair : evaluation.cutoffs.front().all[Index(kind)].pairs) {
    if (pair.object == object) errors[pair.instant] = pair.error_m;
  }
  const double period = evaluation.settings.period_s;
  const auto first = static_cast<std::size_t>(std::max(0.0, when.from_s / period + 0.5));
  const auto last = std::min(static_cast<std::size_t>(std::max(0.0, when.to_s / period + 0.5)),
                             evaluation.grid.size());
  Kept kept;
  kept.was_held = errors.contains(first) || (first > 0 && errors.contains(first - 1));
  std::size_t held = 0;
  for (std::size_t k = first; k < last; ++k) {
    const auto found = errors.find(k);
    if (found != errors.end()) {
      ++held;
      kept.max_error_m = std::max(kept.max_error_m, found->second);
    } else if (kept.lost_after_s < 0.0) {
      kept.lost_after_s = static_cast<double>(k - first) * period;
    }
  }
  kept.share = last > first ? static_cast<double>(held) / static_cast<double>(last - first) : 0.0;
  return kept;
}

std::string LocalWords(const Kept& kept) {
  if (kept.lost_after_s < 0.0) return "LOCAL kept it all the time";
  if (!kept.was_held) return "LOCAL did not hold it then";
  if (kept.lost_after_s == 0.0) return "LOCAL lost it at once";
  return "LOCAL lost it after " + Seconds(kept.lost_after_s);
}

std::string PriorityWords(const Kept& kept, double length_s) {
  const std::string off = ", at most " + Number(kept.max_error_m, 1) + " m off";
  if (kept.lost_after_s < 0.0) return "PRIORITY kept it" + off;
  if (kept.share == 0.0) return "PRIORITY did not hold it";
  return "PRIORITY held it for " + Seconds(kept.share * length_s) + " of that" + off;
}

std::string CriticalWords(const Evaluation& evaluation) {
  const auto critical = CriticalVehicle(evaluation);
  if (!critical) return "No V2V vehicle was out of sight after it had been seen.";
  Interval longest;
  Sighting how = Sighting::kHidden;
  for (const Sighting sighting : {Sighting::kHidden, Sighting::kOutOfView}) {
    for (const Interval& unseen : UnseenIntervals(evaluation, *critical, true, sighting)) {
      if (unseen.to_s - unseen.from_s > longest.to_s - longest.from_s) {
        longest = unseen;
        how = sighting;
      }
    }
  }
  const double length_s = longest.to_s - longest.from_s;
  const Kept local = KeptDuring(evaluation, ListKind::kLocal, *critical, longest);
  const Kept priority = KeptDuring(evaluation, ListKind::kPriority, *critical, longest);
  return "Vehicle " + std::to_string(evaluation.log.truth.objects[*critical].id) + " was " +
         SightingName(how) + " for " + Seconds(length_s) + ", from " + Seconds(longest.from_s) +
         " on; " + LocalWords(local) + "; " + PriorityWords(priority, length_s) + '.';
}

// Over all V2V vehicles.
std::string KeptWords(const Evaluation& evaluation) {
  const double kept_s = evaluation.hidden.seconds + evaluation.out_of_view.seconds;
  const double possible_s =
      evaluation.hidden.possible_seconds + evaluation.out_of_view.possible_seconds;
  if (kept_s <= 0.0 && possible_s <= 0.0) return "";
  std::string text = " In all PRIORITY kept unseen vehicles for " + Seconds(kept_s);
  if (possible_s > kept_s) text += " of the " + Seconds(possible_s) + " in which it could";
  return text + '.';
}

std::string ListWords(const Evaluation& evaluation) {
  const ListScore& local = evaluation.headline(ListKind::kLocal);
  const ListScore& priority = evaluation.headline(ListKind::kPriority);
  std::string text;
  const double possible_s = local.vehicle_seconds - local.bound_missed_seconds;
  if (possible_s > 0.0) {
    const double listed = 100.0 * (1.0 - local.excess_missed_seconds / possible_s);
    text += " LOCAL listed vehicles for " + Number(listed, 0) +
            " % of the time in which its sensors could follow them";
    text += local.false_track_ids == 0
                ? ", and nothing that was not there."
                : "; " + std::to_string(local.false_track_ids) + " of its tracks were false.";
  }
  text += priority.false_track_ids == 0 ? " PRIORITY listed nothing that was not there."
                                        : ' ' + std::to_string(priority.false_track_ids) +
                                              " of PRIORITY's tracks were false.";
  return text;
}

std::string LiarWords(const LiarFacts& liars) {
  const SpoofRun& run = *liars.judged;
  const bool is_phantom = std::ranges::any_of(
      liars.log.bsm_truths, [](const BsmTruth& bsm) { return bsm.is_attack && bsm.vehicle == 0; });
  const std::string what = is_phantom ? "The phantom" : "The liar's vehicle";
  std::string text = ' ' + what;
  if (run.exposure.priority_s <= 0.0) {
    text += " never appeared in PRIORITY";
  } else {
    text += " was in PRIORITY for " + Seconds(run.exposure.priority_s) + ", at most " +
            Number(run.exposure.max_m, 1) + " m from a real vehicle";
  }
  if (run.attackers.empty()) {
    return text + "; its claims were never where the sensors could check them.";
  }
  const SourceOutcome& first = run.attackers.front();
  text += first.met_after_s ? "; doubted after " + Seconds(*first.met_after_s) : "; never doubted";
  text += first.accused_after_s ? ", accused after " + Seconds(*first.accused_after_s)
                                : ", not accused";
  if (run.attackers.size() > 1) {
    text += " (the first of " + std::to_string(run.attackers.size()) + " liars)";
  }
  return text + '.';
}

// The longest stretch that one track of PRIORITY was listed although no sensor saw it.
std::string BridgedWords(const RunLog& log) {
  std::map<std::int64_t, std::pair<Timestamp, Timestamp>> unseen;  // Since, until.
  double longest_s = 0.0;
  std::int64_t longest_id = 0;
  int stretches = 0;
  for (const ReceivedList& list : log.lists[Index(ListKind::kPriority)]) {
    std::set<std::int64_t> now;
    for (const ListedTrack& track : list.tracks) {
      if (track.visibility == 0) continue;
      now.insert(track.id);
      const auto [at, is_new] = unseen.try_emplace(track.id, list.stamp, list.stamp);
      stretches += is_new ? 1 : 0;
      at->second.second = list.stamp;
      const double length_s = ToSeconds(at->second.second - at->second.first);
      if (length_s > longest_s) {
        longest_s = length_s;
        longest_id = track.id;
      }
    }
    std::erase_if(unseen, [&](const auto& entry) { return !now.contains(entry.first); });
  }
  if (stretches == 0) return "";
  return " PRIORITY kept vehicles on their BSMs " + std::to_string(stretches) +
         (stretches == 1 ? " time" : " times") + " while no own sensor saw them, for " +
         Seconds(longest_s) + " at the longest (track " + std::to_string(longest_id % 1'000'000) +
         ").";
}

}  // namespace

std::string SenderText(std::uint32_t sender) {
  char text[12];
  std::snprintf(text, sizeof(text), "%08x", sender);
  return text;
}

std::string Story(const Evaluation& evaluation, const LiarFacts* liars) {
  std::string text = CriticalWords(evaluation) + KeptWords(evaluation) + ListWords(evaluation);
  if (liars != nullptr && liars->has_liar()) text += LiarWords(*liars);
  if (liars != nullptr && liars->judged && !liars->has_liar()) text += " Nobody lied.";
  return text;
}

std::string StoryWithoutTruth(const RunLog& log) {
  if (std::ranges::all_of(log.lists, [](const auto& lists) { return lists.empty(); })) {
    return "The log holds no track lists, so there is nothing to tell of vehicles: run "
           "v2vouch-replay "
           "over it first. Below is what came in.";
  }
  std::string text = "There is no truth to judge by; this is what was listed. ";
  bool is_first = true;
  for (const ListKind kind : {ListKind::kLocal, ListKind::kPriority}) {
    std::set<std::int64_t> ids;
    std::size_t tracks = 0;
    const auto& lists = log.lists[Index(kind)];
    for (const ReceivedList& list : lists) {
      tracks += list.tracks.size();
      for (const ListedTrack& track : list.tracks) ids.insert(track.id);
    }
    text += std::string(is_first ? "" : "; ") + ListTitle(kind) + " held " +
            (ids.empty() ? "no" : std::to_string(ids.size())) +
            (ids.size() == 1 ? " track" : " tracks");
    if (!ids.empty()) {
      text += ", " + Number(static_cast<double>(tracks) / static_cast<double>(lists.size()), 1) +
              " at a time";
    }
    is_first = false;
  }
  text += " in " + Seconds(log.log_seconds) + "." + BridgedWords(log);
  std::set<std::uint32_t> senders;
  for (const BsmArrival& bsm : log.bsms) senders.insert(bsm.sender);
  if (senders.empty()) return text + " No V2V sender spoke.";
  text += ' ' + std::to_string(senders.size()) + (senders.size() == 1 ? " sender" : " senders") +
          " spoke, " + std::to_string(log.bsms.size()) + " BSMs;";
  std::set<std::uint32_t> accused;
  std::set<std::uint32_t> withdrawn;
  for (const VerdictReport& report : log.reports) {
    (report.is_accusation ? accused : withdrawn).insert(report.sender);
  }
  if (accused.empty() && withdrawn.empty()) return text + " none was withdrawn or accused.";
  text += ' ' + std::to_string(withdrawn.size()) + " withdrawn, " + std::to_string(accused.size()) +
          " accused";
  for (const std::uint32_t sender : accused) text += ' ' + SenderText(sender);
  return text + '.';
}

}  // namespace v2vouch::evaluation
