// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "calibration/programs/calibration_run.h"

namespace v2vouch {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string NumberOrNone(const char* format, double value) {
  if (!std::isfinite(value)) return "none";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

template <class... Values>
std::string Line(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

Json RemoteJson(const RemoteSolution& s) {
  char id[16];
  std::snprintf(id, sizeof id, "%08x", s.sender);
  return {{"sender", id},
          {"verdict", VerdictName(s.verdict)},
          {"reason", s.reason},
          {"pairs", s.pairs},
          {"seconds", s.span_s},
          {"bias_east_m", s.bias_en.x()},
          {"bias_north_m", s.bias_en.y()},
          {"bias_east_std_m", std::sqrt(s.bias_covariance(0, 0))},
          {"bias_north_std_m", std::sqrt(s.bias_covariance(1, 1))},
          {"latency_s", s.latency_s},
          {"latency_std_s", s.latency_std_s},
          {"reference_offset_m", s.offset_m},
          {"reference_offset_std_m", s.offset_std_m},
          {"chi2_per_dof", s.chi_square_per_dof},
          {"wander_chi2_per_dof", s.wander_chi_square},
          {"slope_mps", s.slope_mps},
          {"turn_deg", ToDegrees(s.turn_rad)},
          {"turn_std_deg", ToDegrees(s.turn_std_rad)}};
}

}  // namespace

std::string CalibrationVerdicts(const CalibrationRun& run) {
  const auto count = [&](CalibrationVerdict verdict) {
    return static_cast<int>(
        std::ranges::count(run.extrinsics.parameters, verdict, &MountingEstimate::verdict));
  };
  using enum CalibrationVerdict;
  std::string text =
      Line("%d of %zu parameters estimated, %d weakly, %d stay as configured", count(kEstimated),
           run.extrinsics.parameters.size(), count(kWeak), count(kPrior));
  if (const int n = count(kAtBound); n > 0) text += Line(", %d at their bound", n);
  if (const int n = count(kRejected); n > 0) text += Line(", %d rejected", n);
  return text;
}

std::string CalibrationJson(const CalibrationRun& run, double solve_s) {
  const ExtrinsicsResult& result = run.extrinsics;
  Json json;
  json["accepted"] = result.accepted;
  json["problems"] = result.problems;
  json["parameters"] = Json::array();
  for (const MountingEstimate& p : result.parameters) {
    Json shares = Json::object();
    for (const auto& [group, share] : p.shares) shares[group] = share;
    json["parameters"].push_back({{"name", p.name},
                                  {"value", p.value},
                                  {"std", p.std},
                                  {"prior", p.prior},
                                  {"prior_std", p.prior_std},
                                  {"verdict", VerdictName(p.verdict)},
                                  {"determined_by", p.determined_by},
                                  {"crlb", p.crlb},
                                  {"data_std", NumberOrNull(p.data_std)},
                                  {"block_std", p.block_std},
                                  {"shares", shares},
                                  {"hint", p.hint}});
  }
  Json verdicts = Json::object();
  for (const MountingEstimate& p : result.parameters) {
    const std::string verdict = VerdictName(p.verdict);
    verdicts[verdict] = verdicts.value(verdict, 0) + 1;
  }
  json["verdicts"] = verdicts;
  json["weak"] = Json::array();
  for (const WeakDirection& weak : result.weak) {
    json["weak"].push_back({{"information", weak.information}, {"direction", weak.description}});
  }
  json["remotes"] = Json::array();
  for (const RemoteSolution& s : run.remotes) json["remotes"].push_back(RemoteJson(s));
  json["chi2"] = Json::object();
  for (const GroupFit& group : result.groups) {
    json["chi2"][group.name] = {{"equations", group.equations},
                                {"per_equation", group.chi_square_per_equation},
                                {"robust", group.robust_chi_square},
                                {"inflation", group.inflation}};
  }
  const Excitation& e = result.excitation;
  json["excitation"] = {{"duration_s", e.duration_s},
                        {"moving_s", e.moving_s},
                        {"speed_std_mps", e.speed_rms_mps},
                        {"yaw_rate_rms_radps", e.yaw_rate_rms_radps},
                        {"heading_resultant", e.heading_resultant},
                        {"static_returns", e.static_returns},
                        {"target_windows", e.target_windows},
                        {"bearing_std_deg", ToDegrees(e.bearing_spread_rad)},
                        {"inverse_range_std_pm", e.inverse_range_spread_pm}};
  json["covariance"] = {{"names", run.file.correlated}, {"values", run.file.covariance}};
  json["messages"] = e.messages;
  json["events"] = run.events;
  json["refused"] = run.refused;
  json["damaged"] = run.damaged;
  json["solve_s"] = solve_s;
  return json.dump() + "\n";
}

std::string CalibrationText(const CalibrationRun& run, double solve_s) {
  const ExtrinsicsResult& result = run.extrinsics;
  std::string text = Line("%-30s %11s %10s %11s %10s  %s\n", "parameter", "value", "std", "prior",
                          "prior std", "verdict");
  for (const MountingEstimate& p : result.parameters) {
    text += Line("%-30s %11s %10s %11.4f %10.4f  %-9s  %s\n", p.name.c_str(),
                 NumberOrNone("%.4f", p.value).c_str(), NumberOrNone("%.4f", p.std).c_str(),
                 p.prior, p.prior_std, VerdictName(p.verdict),
                 p.hint.empty() ? p.determined_by.c_str() : p.hint.c_str());
  }
  if (!run.remotes.empty()) text += "\nsenders: bias east, north [m], latency [ms]\n";
  for (const RemoteSolution& s : run.remotes) {
    text += Line("%08x  %7.2f +- %.2f  %7.2f +- %.2f  %5.0f +- %3.0f  %-9s  %s\n", s.sender,
                 s.bias_en.x(), std::sqrt(s.bias_covariance(0, 0)), s.bias_en.y(),
                 std::sqrt(s.bias_covariance(1, 1)), 1e3 * s.latency_s, 1e3 * s.latency_std_s,
                 VerdictName(s.verdict), s.reason.c_str());
  }
  text += Line("\n%.1f s of driving, %d static returns, %d target windows; solved in %.1f s\n",
               result.excitation.moving_s, result.excitation.static_returns,
               result.excitation.target_windows, solve_s);
  if (run.damaged > 0 || run.refused > 0) {
    text += Line("%lld damaged stretches and %lld refused messages in the logs were passed over\n",
                 static_cast<long long>(run.damaged), static_cast<long long>(run.refused));
  }
  for (const std::string& problem : result.problems) text += "not accepted: " + problem + "\n";
  if (!result.parameters.empty()) text += CalibrationVerdicts(run) + "\n";
  return text;
}

}  // namespace v2vouch
