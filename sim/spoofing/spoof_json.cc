// SPDX-License-Identifier: Apache-2.0
#include "sim/spoofing/spoof_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/plot/svg.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json Optional(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json Share(double part, double whole) { return whole > 0.0 ? Json(part / whole) : Json(nullptr); }

// Three places are enough for metres and seconds, and keep a campaign's thousands of files small.
double Rounded(double value) { return std::round(value * 1000.0) / 1000.0; }

Json FromConfusion(const Confusion& c) {
  return {{"tp", c.true_positive},
          {"fp", c.false_positive},
          {"fn", c.false_negative},
          {"tn", c.true_negative},
          {"precision", Optional(c.precision())},
          {"recall", Optional(c.recall())},
          {"f1", Optional(c.f1())}};
}

Confusion ToConfusion(const Json& json) {
  return {json.value("tp", std::int64_t{0}), json.value("fp", std::int64_t{0}),
          json.value("fn", std::int64_t{0}), json.value("tn", std::int64_t{0})};
}

Json FromSource(const SourceOutcome& s) {
  return {{"device", s.device},
          {"first_false_s", Rounded(s.first_false_s)},
          {"false_in_view_s", Rounded(s.false_in_view_s)},
          {"met_after_s", Optional(s.met_after_s)},
          {"accused_after_s", Optional(s.accused_after_s)},
          {"detected", s.was_detected}};
}

std::optional<double> ToOptional(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

SourceOutcome ToSource(const Json& json) {
  SourceOutcome s;
  s.device = json.value("device", std::int64_t{0});
  s.first_false_s = json.value("first_false_s", 0.0);
  s.false_in_view_s = json.value("false_in_view_s", 0.0);
  s.met_after_s = ToOptional(json, "met_after_s");
  s.accused_after_s = ToOptional(json, "accused_after_s");
  s.was_detected = json.value("detected", false);
  return s;
}

Json FromExposure(const Exposure& e) {
  Json curve = Json::array();
  for (const double v : e.curve_m) curve.push_back(Rounded(v));
  Json ghosts = Json::array();
  for (const Ghost& ghost : e.ghosts) {
    ghosts.push_back({{"track", ghost.track},
                      {"sender", ghost.sender},
                      {"of_attacker", ghost.is_of_attacker},
                      {"from_s", Rounded(ghost.from_s)},
                      {"to_s", Rounded(ghost.to_s)},
                      {"max_m", Rounded(ghost.max_m)}});
  }
  return {{"max_m", Rounded(e.max_m)},
          {"harm_s", Rounded(e.harm_s)},
          {"lingered_s", Rounded(e.lingered_s)},
          {"original_max_m", Rounded(e.original_max_m)},
          {"original_harm_s", Rounded(e.original_harm_s)},
          {"priority_s", Rounded(e.priority_s)},
          {"curve_m", std::move(curve)},
          {"ghost_publications", e.ghosts.size()},
          {"ghosts", std::move(ghosts)},
          {"instants", e.instants},
          {"outnumbered_instants", e.outnumbered},
          {"doubled_instants", e.doubled}};
}

Exposure ToExposure(const Json& json) {
  Exposure e;
  e.max_m = json.value("max_m", 0.0);
  e.harm_s = json.value("harm_s", 0.0);
  e.lingered_s = json.value("lingered_s", 0.0);
  e.original_max_m = json.value("original_max_m", 0.0);
  e.original_harm_s = json.value("original_harm_s", 0.0);
  e.priority_s = json.value("priority_s", 0.0);
  e.curve_m = json.value("curve_m", std::vector<double>{});
  for (const Json& ghost : json.value("ghosts", Json::array())) {
    e.ghosts.push_back({ghost.value("track", std::int64_t{0}), ghost.value("sender", 0u),
                        ghost.value("of_attacker", false), ghost.value("from_s", 0.0),
                        ghost.value("to_s", 0.0), ghost.value("max_m", 0.0)});
  }
  e.instants = json.value("instants", std::int64_t{0});
  e.outnumbered = json.value("outnumbered_instants", std::int64_t{0});
  e.doubled = json.value("doubled_instants", std::int64_t{0});
  return e;
}

Json FromHonest(const HonestTreatment& h) {
  const double hours = h.vehicle_s / 3600.0;
  return {{"vehicle_s", Rounded(h.vehicle_s)},
          {"withdrawn_s", Rounded(h.withdrawn_s)},
          {"accusations", h.accusations},
          {"withdrawals", h.withdrawals},
          {"senders", h.senders},
          {"accused", h.accused},
          {"in_view", h.in_view},
          {"validated", h.validated},
          {"holdable_s", Rounded(h.holdable_s)},
          {"held_s", Rounded(h.held_s)},
          {"bridges", h.bridges},
          {"bridges_survived", h.bridges_survived},
          {"bridges_same_id", h.bridges_same_id},
          {"bridges_in_budget", h.bridges_in_budget},
          {"survived_in_budget", h.survived_in_budget},
          {"accusations_per_vehicle_hour", Share(h.accusations, hours)},
          {"withdrawn_share", Share(h.withdrawn_s, h.vehicle_s)},
          {"validated_share", Share(h.validated, h.in_view)},
          {"held_share", Share(h.held_s, h.holdable_s)},
          {"bridging_survival", Share(h.bridges_survived, h.bridges)}};
}

HonestTreatment ToHonest(const Json& json) {
  HonestTreatment h;
  h.vehicle_s = json.value("vehicle_s", 0.0);
  h.withdrawn_s = json.value("withdrawn_s", 0.0);
  h.accusations = json.value("accusations", 0);
  h.withdrawals = json.value("withdrawals", 0);
  h.senders = json.value("senders", 0);
  h.accused = json.value("accused", 0);
  h.in_view = json.value("in_view", 0);
  h.validated = json.value("validated", 0);
  h.holdable_s = json.value("holdable_s", 0.0);
  h.held_s = json.value("held_s", 0.0);
  h.bridges = json.value("bridges", 0);
  h.bridges_survived = json.value("bridges_survived", 0);
  h.bridges_same_id = json.value("bridges_same_id", 0);
  h.bridges_in_budget = json.value("bridges_in_budget", 0);
  h.survived_in_budget = json.value("survived_in_budget", 0);
  return h;
}

std::string Percent(double part, double whole) {
  return whole > 0.0 ? Fixed(100.0 * part / whole, 1) + " %" : std::string("none");
}

std::string Line(const std::string& name, const std::string& value) {
  return "  " + name + std::string(name.size() < 34 ? 34 - name.size() : 1, ' ') + value + "\n";
}

std::string ConfusionText(const Confusion& c) {
  const auto text = [](const std::optional<double>& v) {
    return v ? Fixed(*v, 3) : std::string("none");
  };
  return "F1 " + text(c.f1()) + "  precision " + text(c.precision()) + "  recall " +
         text(c.recall()) + "  (" + std::to_string(c.true_positive) + " met, " +
         std::to_string(c.false_negative) + " missed, " + std::to_string(c.false_positive) +
         " honest refused of " + std::to_string(c.false_positive + c.true_negative) + ")";
}

std::string SourceText(const SourceOutcome& s) {
  return "first false in view at " + Fixed(s.first_false_s, 1) + " s, false in view for " +
         Fixed(s.false_in_view_s, 1) + " s, " +
         (s.met_after_s ? "met after " + Fixed(*s.met_after_s, 2) + " s"
                        : std::string("never met")) +
         (s.accused_after_s ? ", accused after " + Fixed(*s.accused_after_s, 2) + " s" : "");
}

}  // namespace

std::string SpoofJson(const SpoofRun& run) {
  Json attackers = Json::array();
  for (const SourceOutcome& source : run.attackers) attackers.push_back(FromSource(source));
  Json json = {{"scenario", run.scenario},
               {"duration_s", Rounded(run.duration_s)},
               {"messages", run.messages},
               {"unanswered", run.unanswered},
               {"false_messages", run.false_messages},
               {"contested", run.contested},
               {"by_message", FromConfusion(run.by_message)},
               {"by_source", FromConfusion(run.by_source)},
               {"attackers", std::move(attackers)},
               {"exposure", FromExposure(run.exposure)},
               {"honest", FromHonest(run.honest)},
               {"gospa",
                {{"local", Optional(run.gospa.local)},
                 {"v2v", Optional(run.gospa.v2v)},
                 {"priority", Optional(run.gospa.priority)}}}};
  if (run.checks_by_message) json["checks_by_message"] = FromConfusion(*run.checks_by_message);
  if (run.checks_by_source) json["checks_by_source"] = FromConfusion(*run.checks_by_source);
  return json.dump() + "\n";
}

bool ReadSpoofJson(const std::string& text, SpoofRun& run) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("by_message") || !json.contains("honest")) return false;
  try {
    run.scenario = json.value("scenario", std::string());
    run.duration_s = json.value("duration_s", 0.0);
    run.messages = json.value("messages", std::int64_t{0});
    run.unanswered = json.value("unanswered", std::int64_t{0});
    run.false_messages = json.value("false_messages", std::int64_t{0});
    run.contested = json.value("contested", std::int64_t{0});
    run.by_message = ToConfusion(json.at("by_message"));
    run.by_source = ToConfusion(json.at("by_source"));
    run.attackers.clear();
    for (const Json& source : json.at("attackers")) run.attackers.push_back(ToSource(source));
    run.exposure = ToExposure(json.at("exposure"));
    run.honest = ToHonest(json.at("honest"));
    run.gospa = {};
    if (json.contains("gospa")) {
      const Json& gospa = json["gospa"];
      run.gospa = {ToOptional(gospa, "local"), ToOptional(gospa, "v2v"),
                   ToOptional(gospa, "priority")};
    }
    if (json.contains("checks_by_message")) {
      run.checks_by_message = ToConfusion(json["checks_by_message"]);
    }
    if (json.contains("checks_by_source")) {
      run.checks_by_source = ToConfusion(json["checks_by_source"]);
    }
  } catch (const Json::exception&) {
    return false;
  }
  return true;
}

std::string SpoofTable(const SpoofRun& run) {
  const Exposure& e = run.exposure;
  const HonestTreatment& h = run.honest;
  const double hours = h.vehicle_s / 3600.0;
  std::string out = (run.scenario.empty() ? std::string("run") : run.scenario) + ", " +
                    Fixed(run.duration_s, 1) + " s, " + std::to_string(run.messages) +
                    " messages, " + std::to_string(run.false_messages) + " false, " +
                    std::to_string(run.unanswered) + " without a verdict\n";
  out += "attack\n";
  out += Line("messages in joint view", ConfusionText(run.by_message));
  out += Line("sources", ConfusionText(run.by_source));
  if (run.checks_by_message) {
    out += Line("message-only checks", ConfusionText(*run.checks_by_message));
  }
  for (const SourceOutcome& s : run.attackers) {
    out += Line("attacker " + std::to_string(s.device), SourceText(s));
  }
  out += Line("exposure", Fixed(e.max_m, 2) + " m at most, " + Fixed(e.harm_s, 2) + " s above " +
                              Number(Exposure::kHarm_m) + " m; to its first vehicle " +
                              Fixed(e.original_max_m, 2) + " m");
  out += Line("ghost publications", std::to_string(e.ghosts.size()) + " (" +
                                        std::to_string(e.ghosts_of_attackers()) + " of attackers)");
  for (const Ghost& ghost : e.ghosts) {
    out += Line("", "track " + std::to_string(ghost.track) + " from " + Fixed(ghost.from_s, 2) +
                        " to " + Fixed(ghost.to_s, 2) + " s, up to " + Fixed(ghost.max_m, 1) +
                        " m from anything real");
  }
  out += Line("instants outnumbered, doubled", std::to_string(e.outnumbered) + ", " +
                                                   std::to_string(e.doubled) + " of " +
                                                   std::to_string(e.instants));
  const auto gospa = [](const std::optional<double>& v) {
    return v ? Fixed(*v, 2) + " m" : std::string("none");
  };
  out +=
      Line("GOSPA of V2V, PRIORITY, LOCAL",
           gospa(run.gospa.v2v) + ", " + gospa(run.gospa.priority) + ", " + gospa(run.gospa.local));
  out += "honest senders\n";
  out +=
      Line("heard", std::to_string(h.senders) + " devices, " + Fixed(hours, 3) + " vehicle-hours");
  out += Line("accusations, withdrawals",
              std::to_string(h.accusations) + ", " + std::to_string(h.withdrawals));
  out += Line("withdrawn share of time", Percent(h.withdrawn_s, h.vehicle_s));
  out += Line("validated share", Percent(h.validated, h.in_view) + " of " +
                                     std::to_string(h.in_view) + " messages in view");
  out += Line("held in PRIORITY",
              Percent(h.held_s, h.holdable_s) + " of " + Fixed(h.holdable_s, 1) + " s possible");
  out += Line("unseen for 3..6 s", std::to_string(h.bridges) + ", survived " +
                                       std::to_string(h.bridges_survived) + " (within the budget " +
                                       std::to_string(h.bridges_in_budget) + ", survived " +
                                       std::to_string(h.survived_in_budget) + "), same id after " +
                                       std::to_string(h.bridges_same_id));
  return out;
}

}  // namespace v2vouch::evaluation
