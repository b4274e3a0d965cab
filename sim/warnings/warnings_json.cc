// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/warnings/judge_warnings.h"
#include "sim/warnings/warn_tally.h"

namespace v2vouch::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

Json OutcomeJson(const Outcome& outcome, bool brakes, bool is_needed) {
  return {{"brakes", brakes},
          {"contact", outcome.has_contact},
          {"contact_speed_mps", outcome.contact_speed_mps},
          {"needless", brakes && !is_needed},
          {"speed_lost_mps", outcome.speed_lost_mps}};
}

}  // namespace

std::string WarnScoreJson(const WarnScore& score) {
  nlohmann::ordered_json consumers;
  const bool is_needed = score.unwarned.has_contact;
  for (const Consumer consumer : kConsumers) {
    const ConsumerScore& each = score.consumers[static_cast<std::size_t>(consumer)];
    nlohmann::ordered_json kinds = nlohmann::ordered_json::object();
    for (const auto& [kind, counts] : each.kinds) {
      kinds[warnings::KindName(kind)] = {{"true", counts.true_count},
                                         {"late", counts.late},
                                         {"false", counts.false_count},
                                         {"early", counts.early},
                                         {"missed", counts.missed},
                                         {"unavoidable", counts.unavoidable},
                                         {"urgent", counts.urgent},
                                         {"urgent_false", counts.urgent_false},
                                         {"urgent_false_unseen", counts.urgent_false_unseen},
                                         {"false_by_lie", counts.false_by_lie},
                                         {"urgent_by_lie", counts.urgent_by_lie},
                                         {"delays_s", counts.delays_s}};
    }
    consumers[ConsumerKey(consumer)] = {
        {"kinds", kinds},
        {"planner", OutcomeJson(each.planner, each.planner_brakes, is_needed)},
        {"driver", OutcomeJson(each.driver, each.driver_brakes, is_needed)},
        {"first_urgent_s", Number(each.first_urgent_s)},
        {"first_warn_s", Number(each.first_warn_s)},
        {"lta_hidden_s", each.lta_hidden_s},
        {"lta_hidden_held_s", each.lta_hidden_held_s}};
  }
  return nlohmann::ordered_json{{"scenario", score.scenario},
                                {"seconds", score.seconds},
                                {"contact_unwarned", is_needed},
                                {"truth_first_urgent_s", Number(score.truth_first_urgent_s)},
                                {"truth_first_warn_s", Number(score.truth_first_warn_s)},
                                {"consumers", consumers}}
             .dump() +
         "\n";
}

namespace {

ConsumerTally TallyOf(const Json& json) {
  ConsumerTally tally;
  for (const auto& [kind, counts] : json.at("kinds").items()) {
    tally.true_count += counts.at("true").get<int>();
    tally.late += counts.at("late").get<int>();
    tally.early += counts.at("early").get<int>();
    tally.missed += counts.at("missed").get<int>();
    tally.unavoidable += counts.at("unavoidable").get<int>();
    tally.false_count += counts.at("false").get<int>();
    tally.false_by_lie += counts.at("false_by_lie").get<int>();
    tally.urgent += counts.at("urgent").get<int>();
    tally.urgent_false += counts.at("urgent_false").get<int>();
    tally.urgent_by_lie += counts.at("urgent_by_lie").get<int>();
    for (const Json& delay : counts.at("delays_s")) tally.delays_s.push_back(delay.get<double>());
  }
  const Json& planner = json.at("planner");
  const Json& driver = json.at("driver");
  tally.planner_contacts = planner.at("contact").get<bool>();
  tally.driver_contacts = driver.at("contact").get<bool>();
  tally.planner_needless = planner.at("needless").get<bool>();
  tally.driver_needless = driver.at("needless").get<bool>();
  if (tally.planner_needless > 0) tally.speed_lost_mps = planner.at("speed_lost_mps").get<double>();
  tally.runs_by_lie = tally.urgent_by_lie > 0;
  return tally;
}

}  // namespace

bool ReadWarnTally(const std::string& text, WarnTally& tally) {
  const Json json = Json::parse(text, nullptr, false);
  try {
    tally = {};
    tally.runs = 1;
    tally.seconds = json.at("seconds").get<double>();
    tally.contacts_unwarned = json.at("contact_unwarned").get<bool>();
    const Json& consumers = json.at("consumers");
    tally.v2v = TallyOf(consumers.at("v2v"));
    tally.local = TallyOf(consumers.at("local"));
    tally.ours = TallyOf(consumers.at("ours"));
  } catch (const Json::exception&) {
    return false;
  }
  return true;
}

}  // namespace v2vouch::evaluation
