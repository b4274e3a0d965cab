// SPDX-License-Identifier: Apache-2.0
#include "sim/report/liar_section.h"

#include <algorithm>
#include <map>

#include "sim/plot/svg.h"
#include "sim/report/trust_strip.h"

namespace v2vouch::evaluation {
namespace {

struct Liar {
  std::int64_t device = 0;
  std::vector<std::uint32_t> ids;
  std::int64_t false_messages = 0;
  double first_s = 0.0, last_s = 0.0;
  bool is_phantom = false;
  double off_max_m = 0.0;  // Of the claims, from the vehicle it speaks for.
};

std::vector<Liar> LiarsOf(const RunLog& log) {
  std::map<std::int64_t, Liar> liars;
  for (const BsmTruth& bsm : log.bsm_truths) {
    if (!bsm.is_attack) continue;
    Liar& liar = liars[bsm.device];
    const double t_s = ToSeconds(bsm.stamp - log.truth.begin());
    if (liar.false_messages == 0) liar.first_s = t_s;
    liar.device = bsm.device;
    liar.last_s = t_s;
    ++liar.false_messages;
    liar.is_phantom = liar.is_phantom || bsm.vehicle == 0;
    const double off_m = (bsm.claimed.p_W - bsm.honest.p_W).norm();
    if (off_m == off_m) liar.off_max_m = std::max(liar.off_max_m, off_m);
    if (std::ranges::find(liar.ids, bsm.sender) == liar.ids.end()) liar.ids.push_back(bsm.sender);
  }
  std::vector<Liar> sorted;
  for (auto& [device, liar] : liars) sorted.push_back(std::move(liar));
  return sorted;
}

std::string OrNever(const std::optional<double>& seconds) {
  return seconds ? Number(*seconds, 1) + " s" : "never";
}

}  // namespace

std::string LiarSection(const Evaluation& evaluation, const LiarFacts& liars) {
  std::string out =
      "<table class=\"text\"><tr><th>liar</th><th>ids</th><th>false messages</th><th>from, to "
      "[s]</th>"
      "<th>claims</th><th>doubted after</th><th>accused after</th></tr>\n";
  std::vector<std::uint32_t> ids;
  for (const Liar& liar : LiarsOf(liars.log)) {
    const auto outcome =
        std::ranges::find(liars.judged->attackers, liar.device, &SourceOutcome::device);
    const bool is_judged = outcome != liars.judged->attackers.end();
    std::string names;
    for (const std::uint32_t id : liar.ids) {
      if (names.size() < 60) names += (names.empty() ? "" : " ") + SenderText(id);
      ids.push_back(id);
    }
    if (names.size() >= 60) names += " ...";
    out += "<tr><td class=\"liar\">" + std::to_string(liar.device) + "</td><td>" + names +
           "</td><td>" + std::to_string(liar.false_messages) + "</td><td>" +
           Number(liar.first_s, 1) + ", " + Number(liar.last_s, 1) + "</td><td>" +
           (liar.is_phantom ? "a vehicle that is not there"
                            : "up to " + Number(liar.off_max_m, 1) + " m off") +
           "</td><td>" + (is_judged ? OrNever(outcome->met_after_s) : "not in view") + "</td><td>" +
           (is_judged ? OrNever(outcome->accused_after_s) : "not in view") + "</td></tr>\n";
  }
  const Exposure& exposure = liars.judged->exposure;
  out += "</table>\n<p>" +
         (exposure.priority_s > 0.0
              ? "In PRIORITY for " + Number(exposure.priority_s, 1) + " s, at most " +
                    Number(exposure.max_m, 1) + " m from everything real, more than 3 m for " +
                    Number(exposure.harm_s, 1) + " s."
              : std::string("Never in PRIORITY.")) +
         " Times count from the first false claim that the sensors could check.</p>\n";
  out += TrustStrips(evaluation.log, ids, evaluation.log.truth.begin(),
                     std::max(1.0, evaluation.duration_s), 8);
  out +=
      "<table class=\"text\"><tr><th>verdict at</th><th>sender</th><th>check</th><th></th></tr>\n";
  int rows = 0;
  for (const VerdictReport& report : evaluation.log.reports) {
    if (std::ranges::find(ids, report.sender) == ids.end() || ++rows > 12) continue;
    out += "<tr><td>" + Number(ToSeconds(report.received - evaluation.log.truth.begin()), 1) +
           " s</td><td>" + SenderText(report.sender) + "</td><td>" + Escape(report.check) +
           "</td><td>" + (report.is_accusation ? "accused" : "withdrawn") + "</td></tr>\n";
  }
  if (rows == 0) out += "<tr><td>none</td><td></td><td></td><td></td></tr>\n";
  return out + "</table>\n";
}

}  // namespace v2vouch::evaluation
