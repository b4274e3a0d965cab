// SPDX-License-Identifier: Apache-2.0
#include "sim/report/scorecard_text.h"

#include <cstdio>

#include "daemon/common/base/angle.h"
#include "sim/metrics/scoring.h"
#include "sim/plot/svg.h"
#include "sim/report/behaviour_text.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json ErrorJson(const Sample& sample) {
  return {{"samples", sample.count()},
          {"rms_m", Rounded(sample.Rms())},
          {"median_m", Rounded(sample.Median())},
          {"p95_m", Rounded(sample.Quantile(0.95))}};
}

Json PositionJson(const ErrorParts& parts) {
  return {{"all", ErrorJson(parts.all)},
          {"moving", ErrorJson(parts.moving)},
          {"standing", ErrorJson(parts.standing)},
          {"partly_hidden", ErrorJson(parts.partly_hidden)},
          {"plain_sight", ErrorJson(parts.plain)},
          {"cars", ErrorJson(parts.cars)},
          {"vans", ErrorJson(parts.vans)},
          {"lorries", ErrorJson(parts.lorries)},
          {"motorcycles", ErrorJson(parts.motorcycles)}};
}

Json YawJson(const Sample& error_rad) {
  return {{"samples", error_rad.count()},
          {"median_deg", Rounded(ToDegrees(error_rad.Median()))},
          {"rms_deg", Rounded(ToDegrees(error_rad.Rms()))},
          {"reversed_share", Rounded(error_rad.ShareAbove(kPi / 2.0))}};
}

Json NeesJson(const ConsistencyFigures& figures) {
  return {
      {"samples", figures.nees.count()},
      {"anees", Rounded(figures.nees.Mean())},
      {"median", Rounded(figures.nees.Median())},
      {"share_above_9.21", Rounded(figures.nees.ShareAbove(ConsistencyFigures::kOneInHundred))}};
}

Json BridgeJson(const BridgeFigures& bridge) {
  return {{"samples", bridge.samples},
          {"kept_share", Rounded(Share(bridge.kept, bridge.samples))},
          {"covered", bridge.covered},
          {"covered_kept_share", Rounded(Share(bridge.covered_kept, bridge.covered))},
          {"rms_m", Rounded(bridge.error_m.Rms())}};
}

Json UnseenJson(const UnseenFigures& unseen) {
  return {{"ids", unseen.ids},
          {"lasting_ids", unseen.lasting_ids},
          {"seconds", Rounded(unseen.seconds)},
          {"coasting_share", Rounded(Share(unseen.coasting, unseen.entries))}};
}

Json ListingJson(const FirstListingFigures& listing) {
  return {{"listed", listing.delay_s.count()},
          {"mean_s", Rounded(listing.delay_s.Mean())},
          {"p95_s", Rounded(listing.delay_s.Quantile(0.95))},
          {"never", listing.never}};
}

Json LeadJson(const LeadFigures& lead) {
  return {{"lists", lead.lists},
          {"absent", lead.absent},
          {"absent_share", Rounded(lead.absent_share())},
          {"longest_absence_s", Rounded(lead.longest_absence_s)},
          {"along_rms_m", Rounded(lead.along_m.Rms())},
          {"along_mean_m", Rounded(lead.along_m.Mean())}};
}

Json LorryJson(const LorryFigures& lorry) {
  return {{"samples", lorry.near_face_m.count()},
          {"near_face_rms_m", Rounded(lorry.near_face_m.Rms())},
          {"near_face_mean_m", Rounded(lorry.near_face_m.Mean())},
          {"length_error_rms_m", Rounded(lorry.length_error_m.Rms())},
          {"length_error_largest_m", Rounded(lorry.length_error_m.Largest())}};
}

Json CardJson(const Scorecard& card) {
  Json json = {{"instants", card.instants},
               {"lists", card.lists},
               {"position", PositionJson(card.position)},
               {"lorry", LorryJson(card.lorry)},
               {"velocity_rms_mps", Rounded(card.velocity_mps.Rms())},
               {"velocity_median_mps", Rounded(card.velocity_mps.Median())},
               {"yaw_moving", YawJson(card.yaw_moving_rad)},
               {"yaw_standing", YawJson(card.yaw_standing_rad)},
               {"nees_visible", NeesJson(card.visible)},
               {"nees_hidden", NeesJson(card.hidden)},
               {"missed_share", Rounded(card.missed_visible.share())},
               {"missed_plain_sight_share", Rounded(card.missed_plain.share())},
               {"false_per_list", Rounded(card.false_per_list())},
               {"unseen", UnseenJson(card.unseen)},
               {"switches", card.switches},
               {"first_listing",
                {{"moving", ListingJson(card.first_listing.moving)},
                 {"plain_sight", ListingJson(card.first_listing.plain)}}},
               {"lead", LeadJson(card.lead)}};
  if (card.kind != ListKind::kPriority) return json;
  json["hidden_1_2_s"] = BridgeJson(card.hidden_1_2_s);
  json["hidden_3_4_s"] = BridgeJson(card.hidden_3_4_s);
  json["hidden_1_4_s"] = BridgeJson(card.hidden_1_4_s);
  json["validated_share"] = Rounded(Share(card.validated, card.validated_of));
  json["validated_of_s"] = Rounded(static_cast<double>(card.validated_of) * card.settings.period_s);
  return json;
}

std::string Rms(const Sample& sample) { return Fixed(sample.Rms(), 2); }

std::string NeesText(const ConsistencyFigures& figures) {
  return Fixed(figures.nees.Mean(), 2) + " (median " + Fixed(figures.nees.Median(), 2) + ", " +
         WithUnit(100.0 * figures.nees.ShareAbove(ConsistencyFigures::kOneInHundred), 1, " %") +
         " above 9.21)";
}

std::string ListingText(const FirstListingFigures& listing) {
  return "mean " + WithUnit(listing.delay_s.Mean(), 2, " s") + ", p95 " +
         WithUnit(listing.delay_s.Quantile(0.95), 2, " s") + Line(", never %d", listing.never);
}

std::string BridgeText(const char* title, const BridgeFigures& bridge) {
  return std::string(title) + WithUnit(bridge.error_m.Rms(), 2, " m") + ", " +
         WithUnit(100.0 * Share(bridge.kept, bridge.samples), 0, " %") + " kept (" +
         WithUnit(100.0 * Share(bridge.covered_kept, bridge.covered), 0, " %") +
         " of what the budget covers)";
}

std::string CardLines(const Scorecard& card) {
  const ErrorParts& p = card.position;
  std::string out = Line("  %s\n", ListTitle(card.kind));
  out += "    position RMS [m]: " + Rms(p.all) + "; moving " + Rms(p.moving) + ", standing " +
         Rms(p.standing) + ", partly hidden " + Rms(p.partly_hidden) + ", cars in plain sight " +
         Rms(p.plain) + "\n    cars " + Rms(p.cars) + ", vans " + Rms(p.vans) +
         ", lorries and buses " + Rms(p.lorries) + " (near face " + Rms(card.lorry.near_face_m) +
         ", length at most +" + Fixed(card.lorry.length_error_m.Largest(), 1) + "), motorcycles " +
         Rms(p.motorcycles) + "\n";
  out += "    velocity RMS " + WithUnit(card.velocity_mps.Rms(), 2, " m/s") +
         "; yaw error, median: moving " +
         WithUnit(ToDegrees(card.yaw_moving_rad.Median()), 1, " deg") + ", standing " +
         WithUnit(ToDegrees(card.yaw_standing_rad.Median()), 1, " deg") + "\n";
  out += "    ANEES visible " + NeesText(card.visible) + "; hidden " + NeesText(card.hidden) + "\n";
  out += "    missed " + WithUnit(100.0 * card.missed_visible.share(), 1, " %") +
         ", in plain sight " + WithUnit(100.0 * card.missed_plain.share(), 1, " %") +
         "; false per list " + Fixed(card.false_per_list(), 3) +
         Line("; seen by nobody: %d ids (%d for > 0.5 s), %.1f s, ", card.unseen.ids,
              card.unseen.lasting_ids, card.unseen.seconds) +
         WithUnit(100.0 * Share(card.unseen.coasting, card.unseen.entries), 0, " %") +
         Line(" coasting; identity switches %d\n", card.switches);
  out += "    first listing: moving " + ListingText(card.first_listing.moving) +
         "; in plain sight " + ListingText(card.first_listing.plain) + "\n";
  out += Line("    lead vehicle: absent in %lld of %lld lists (longest %.1f s), along RMS ",
              static_cast<long long>(card.lead.absent), static_cast<long long>(card.lead.lists),
              card.lead.longest_absence_s) +
         WithUnit(card.lead.along_m.Rms(), 2, " m") + ", mean " +
         WithUnit(card.lead.along_m.Mean(), 2, " m") + "\n";
  if (card.kind != ListKind::kPriority) return out;
  return out + "    hidden " + BridgeText("1 to 2 s: ", card.hidden_1_2_s) + "; " +
         BridgeText("3 to 4 s: ", card.hidden_3_4_s) + "\n    validated share " +
         WithUnit(100.0 * Share(card.validated, card.validated_of), 1, " %") + "\n";
}

}  // namespace

Json ScorecardJson(const Scorecards& cards) {
  return {{"local", CardJson(cards.local)}, {"priority", CardJson(cards.priority)}};
}

std::string ScorecardTable(const Scorecards& cards) {
  return Line("scorecard (10 lists a second in their last correction; vehicles within %g m)\n",
              cards.local.settings.near_m) +
         CardLines(cards.local) + CardLines(cards.priority);
}

std::string ScorecardFileJson(const RunLog& log, const Scorecards& cards) {
  const Json json = {{"scenario", log.specs.name},
                     {"cutoff_m", cards.local.settings.cutoff_m},
                     {"duration_s", Rounded(ToSeconds(log.truth.end() - log.truth.begin()))},
                     {"scorecard", ScorecardJson(cards)}};
  return json.dump(1) + "\n";
}

}  // namespace v2vouch::evaluation
