// SPDX-License-Identifier: Apache-2.0
#include "sim/report/behaviour_text.h"

#include <cmath>
#include <cstdio>

#include "daemon/common/base/angle.h"
#include "sim/plot/svg.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kSightings = {Sighting::kVisible, Sighting::kHidden, Sighting::kOutOfView};
constexpr std::array kSightingKeys = {"visible", "hidden", "out_of_view"};
constexpr std::array kSightingNames = {"visible", "hidden", "out of view"};

Json VisibilityJson(const VisibilityTable& table) {
  Json json = {{"samples", table.total()}, {"share_right", Rounded(table.share_right())}};
  for (std::size_t said = 0; said < 3; ++said) {
    const Sighting sighting = kSightings[said];
    Json& row = json["said"][kSightingKeys[said]];
    for (std::size_t is = 0; is < 3; ++is) {
      row[std::string("truly_") + kSightingKeys[is]] = table.count[said][is];
    }
    row["share_right"] = Rounded(table.share_right_of_said(sighting));
    row["share_of_true_found"] = Rounded(table.share_found_of_true(sighting));
  }
  return json;
}

Json HeadingJson(const HeadingFigures& heading) {
  return {{"samples", heading.samples},
          {"tracks", heading.tracks},
          {"flips", heading.flips},
          {"born_reversed", heading.born_reversed},
          {"reversed_samples", heading.reversed},
          {"rms_moving_deg", Rounded(ToDegrees(heading.rms_moving_rad))},
          {"rms_standing_deg", Rounded(ToDegrees(heading.rms_standing_rad))}};
}

Json PartJson(const LocalisationPart& part) {
  return {{"rms_m", Rounded(part.rms_m)},
          {"ratio", Rounded(part.ratio)},
          {"vehicle_seconds", Rounded(part.seconds)}};
}

Json ListJson(const ListBehaviour& list) {
  return {
      {"visibility", VisibilityJson(list.visibility)},
      {"heading", HeadingJson(list.heading)},
      {"localisation", {{"moving", PartJson(list.moving)}, {"standing", PartJson(list.standing)}}}};
}

Json MeanJson(const Confirmation::Mean& mean) {
  return {{"vehicles", mean.vehicles},
          {"listed", mean.listed},
          {"looks_mean", Rounded(mean.looks)},
          {"looks_median", Rounded(mean.looks_median)},
          {"expected_hits_mean", Rounded(mean.expected_hits)},
          {"delay_mean_s", Rounded(mean.delay_s)}};
}

std::string ListLines(const char* name, const ListBehaviour& list) {
  const HeadingFigures& heading = list.heading;
  const auto part = [](const LocalisationPart& p) {
    if (std::isnan(p.rms_m)) return std::string("none");
    return Fixed(p.rms_m, 3) + " m RMS (" + WithUnit(p.ratio, 2, " x bound") + ")";
  };
  std::string out = Line("  %-8s moving ", name) + part(list.moving) + ", standing " +
                    part(list.standing) + "\n           heading RMS " +
                    WithUnit(ToDegrees(heading.rms_moving_rad), 1, " deg") + " moving, " +
                    WithUnit(ToDegrees(heading.rms_standing_rad), 1, " deg") + " standing; " +
                    Line("%d flips, %d born reversed, in %d tracks\n", heading.flips,
                         heading.born_reversed, heading.tracks);
  out += "           visibility said right " +
         WithUnit(100.0 * list.visibility.share_right(), 1, " %") + "; ";
  for (std::size_t said = 0; said < 3; ++said) {
    out += Line("%s %s: %lld/%lld/%lld", said == 0 ? "" : ",", kSightingNames[said],
                static_cast<long long>(list.visibility.count[said][0]),
                static_cast<long long>(list.visibility.count[said][1]),
                static_cast<long long>(list.visibility.count[said][2]));
  }
  return out + "\n";
}

std::string VisibilityHtml(const char* name, const VisibilityTable& table) {
  std::string out = std::string("<table><tr><th>") + name +
                    " says</th><th>truly visible</th><th>truly hidden</th><th>truly out of "
                    "view</th><th>right</th></tr>\n";
  for (std::size_t said = 0; said < 3; ++said) {
    out += std::string("<tr><td>") + kSightingNames[said] + "</td>";
    for (std::size_t is = 0; is < 3; ++is) {
      out += "<td>" + std::to_string(table.count[said][is]) + "</td>";
    }
    out += "<td>" +
           (table.said(kSightings[said]) > 0
                ? Number(100.0 * table.share_right_of_said(kSightings[said]), 1) + " %"
                : std::string("none")) +
           "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string ListRows(const char* name, const ListBehaviour& list) {
  const auto cell = [](double value, int digits) {
    return "<td>" + Fixed(value, digits) + "</td>";
  };
  return std::string("<tr><td>") + name + "</td>" + cell(list.moving.rms_m, 3) +
         cell(list.moving.ratio, 2) + cell(list.standing.rms_m, 3) + cell(list.standing.ratio, 2) +
         cell(ToDegrees(list.heading.rms_moving_rad), 1) +
         cell(ToDegrees(list.heading.rms_standing_rad), 1) + cell(list.heading.flips, 0) +
         cell(list.heading.born_reversed, 0) + cell(100.0 * list.visibility.share_right(), 1) +
         "</tr>\n";
}

}  // namespace

double Rounded(double value) {
  if (!std::isfinite(value) || value == 0.0) return std::isfinite(value) ? 0.0 : value;
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return std::strtod(text, nullptr);
}

std::string WithUnit(double value, int digits, const char* unit) {
  return std::isfinite(value) ? Fixed(value, digits) + unit : "none";
}

std::string UnseenText(const UnseenError& error) {
  if (!(error.seconds > 0.0)) {
    return "none (the bound could keep " + Fixed(error.possible_seconds, 1) + " vehicle-seconds)";
  }
  return Fixed(error.rms_m, 2) + " m RMS, " + Fixed(error.max_m, 2) + " m at most, over " +
         Fixed(error.seconds, 1) + " vehicle-seconds (the bound could keep " +
         Fixed(error.possible_seconds, 1) + ")";
}

std::string AneesText(const Anees& anees) {
  if (anees.count == 0) return "none";
  return Line("%.2f (band %.2f to %.2f, %.0f independent of %lld)", anees.mean(), anees.low,
              anees.high, anees.independent, static_cast<long long>(anees.count));
}

Json BehaviourJson(const Behaviour& behaviour) {
  Json json = {{"local", ListJson(behaviour.local)}, {"priority", ListJson(behaviour.priority)}};
  using Of = Confirmation::Of;
  json["confirmation"] = {{"all", MeanJson(behaviour.confirmation.Average(Of::kAll))},
                          {"moving", MeanJson(behaviour.confirmation.Average(Of::kMoving))},
                          {"standing", MeanJson(behaviour.confirmation.Average(Of::kStanding))}};
  return json;
}

std::string BehaviourTable(const Behaviour& behaviour) {
  std::string out =
      "behaviour (visibility said: truly visible/hidden/out of view; heading of tracks older than "
      "1 s)\n";
  out += ListLines("LOCAL", behaviour.local);
  out += ListLines("PRIORITY", behaviour.priority);
  const auto& confirmation = behaviour.confirmation;
  const auto all = confirmation.Average(Confirmation::Of::kAll);
  const auto moving = confirmation.Average(Confirmation::Of::kMoving);
  out += "confirmation: " + WithUnit(all.looks, 2, " looks") + " (" +
         WithUnit(all.delay_s, 2, " s") +
         Line(") on average over %d of %d vehicles, median ", all.listed, all.vehicles) +
         Fixed(all.looks_median, 1) + "; moving " + WithUnit(moving.looks, 2, " looks") +
         Line(" over %d of %d\n", moving.listed, moving.vehicles);
  return out;
}

std::string BehaviourHtml(const Behaviour& behaviour) {
  std::string out =
      "<table><tr><th></th><th>moving, RMS [m]</th><th>/ bound</th><th>standing, RMS "
      "[m]</th><th>/ bound</th><th>heading moving, RMS [&deg;]</th><th>standing</th><th>flips</th>"
      "<th>born reversed</th><th>visibility right [%]</th></tr>\n";
  out += ListRows("LOCAL", behaviour.local) + ListRows("PRIORITY", behaviour.priority);
  out += "</table>\n" + VisibilityHtml("LOCAL", behaviour.local.visibility) +
         VisibilityHtml("PRIORITY", behaviour.priority.visibility);
  out +=
      "<table><tr><th>first in LOCAL</th><th>vehicles seen</th><th>listed</th><th>looks, "
      "mean</th><th>looks, median</th><th>delay [s]</th></tr>\n";
  using Of = Confirmation::Of;
  for (const auto& [name, which] :
       {std::pair("all", Of::kAll), {"moving", Of::kMoving}, {"standing", Of::kStanding}}) {
    const auto mean = behaviour.confirmation.Average(which);
    out += std::string("<tr><td>") + name + "</td><td>" + std::to_string(mean.vehicles) +
           "</td><td>" + std::to_string(mean.listed) + "</td><td>" + Fixed(mean.looks, 2) +
           "</td><td>" + Fixed(mean.looks_median, 1) + "</td><td>" + Fixed(mean.delay_s, 2) +
           "</td></tr>\n";
  }
  return out + "</table>\n";
}

}  // namespace v2vouch::evaluation
