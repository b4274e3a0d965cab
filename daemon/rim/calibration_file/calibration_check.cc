// SPDX-License-Identifier: Apache-2.0
// What makes a calibration nonsense, whatever car it is for.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "daemon/rim/calibration_file/calibration_file.h"
#include "daemon/rim/config/number_text.h"

namespace v2vouch {
namespace {

constexpr int kVersion = 1;
constexpr std::size_t kMaxParameters = 512;
constexpr std::size_t kMaxNameLength = 100;

constexpr std::array<std::string_view, 3> kOfRadar = {"x_m", "y_m", "yaw_deg"};
constexpr std::array<std::string_view, 6> kOfCamera = {"x_m",     "y_m",       "z_m",
                                                       "yaw_deg", "pitch_deg", "roll_deg"};
constexpr std::array<std::string_view, 7> kOfEgo = {
    "antenna_x_m",         "antenna_y_m",  "heading_bias_deg", "speed_scale",
    "yaw_rate_bias_degps", "odometer_y_m", "slip_s2pm"};

bool IsParameterName(std::string_view name) {
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos || name.size() > kMaxNameLength) return false;
  const std::string_view owner = name.substr(0, dot);
  const auto is_among = [key = name.substr(dot + 1)](const auto& keys) {
    return std::ranges::find(keys, key) != keys.end();
  };
  if (owner == "ego") return is_among(kOfEgo);
  if (owner.starts_with("radar_") && owner.size() > 6) return is_among(kOfRadar);
  return owner.starts_with("camera_") && owner.size() > 7 && is_among(kOfCamera);
}

// For messages: short, and no control characters on the user's terminal.
std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, kMaxNameLength));
  for (char& c : shown) c = static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return '"' + shown + '"';
}

bool IsSha256(std::string_view text) {
  return text.size() == 64 && std::ranges::all_of(text, [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

// 2026-11-22T17:43:44Z, with or without a fraction of the second.
bool IsUtc(std::string_view text) {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:dd";
  if (text.size() <= kForm.size() || text.back() != 'Z') return false;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] == 'd' ? !is_digit(text[i]) : text[i] != kForm[i]) return false;
  }
  const std::string_view fraction = text.substr(kForm.size(), text.size() - kForm.size() - 1);
  return fraction.empty() || (fraction.size() > 1 && fraction.size() <= 10 && fraction[0] == '.' &&
                              std::ranges::all_of(fraction.substr(1), is_digit));
}

// Symmetric and without a direction of negative variance, judged on correlations so that metres and
// degrees count alike. Rounding may leave a perfect correlation a little below zero.
std::string WrongWith(const std::vector<std::string>& names, const std::vector<double>& values) {
  constexpr double kRounding = 1e-9;
  const auto n = static_cast<Eigen::Index>(names.size());
  if (values.size() != names.size() * names.size()) {
    return "has " + std::to_string(values.size()) + " numbers for " + std::to_string(n) +
           " correlated names: must have their square";
  }
  if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) {
    return "holds a number that is not finite";
  }
  if (n == 0) return "";
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      covariance(values.data(), n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    if (!(covariance(i, i) > 0.0)) return "has no positive variance for " + name;
  }
  const Eigen::VectorXd inverse_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation =
      inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
  if (!correlation.allFinite()) return "has variances that no number can hold";
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (std::abs(correlation(i, j) - correlation(j, i)) <= kRounding) continue;
      return "is not symmetric in " + names[static_cast<std::size_t>(j)] + " and " +
             names[static_cast<std::size_t>(i)];
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation, Eigen::EigenvaluesOnly);
  const bool is_positive = solver.info() == Eigen::Success &&
                           solver.eigenvalues()[0] >= -kRounding * static_cast<double>(n);
  return is_positive ? "" : "is not positive: it holds a direction of negative variance";
}

}  // namespace

void CheckCalibration(const CalibrationFile& calibration, const std::string& name,
                      std::vector<std::string>& problems) {
  const auto report = [&](const std::string& what) { problems.push_back(name + ": " + what); };
  if (calibration.version != kVersion) {
    return report("version = " + std::to_string(calibration.version) +
                  ": this program knows version " + std::to_string(kVersion));
  }
  if (!calibration.created.empty() && !IsUtc(calibration.created)) {
    report("created = " + Shown(calibration.created) + ": must be like 2026-01-31T23:59:59Z");
  }
  for (const std::string& digest : calibration.log_sha256) {
    if (!IsSha256(digest)) report("log_sha256: " + Shown(digest) + ": must have 64 hex digits");
  }
  if (calibration.parameters.empty()) report("parameters: there are none");
  if (calibration.parameters.size() > kMaxParameters) return report("parameters: more than 512");

  std::set<std::string_view> names;
  for (const CalibratedParameter& parameter : calibration.parameters) {
    const std::string shown = Shown(parameter.name);
    if (!IsParameterName(parameter.name)) report("parameter " + shown + ": unknown name");
    if (!names.insert(parameter.name).second) report("parameter " + shown + ": stands twice");
    const auto check = [&](const char* key, double value, bool must_be_positive) {
      const bool is_good = std::isfinite(value) && (!must_be_positive || value > 0.0);
      if (is_good) return;
      report(parameter.name + ": " + key + " = " + config::NumberText(value) +
             (must_be_positive ? ": must be finite and above 0" : ": must be finite"));
    };
    check("value", parameter.value, false);
    check("std", parameter.std, true);
    check("prior", parameter.prior, false);
    check("prior_std", parameter.prior_std, true);
  }
  std::set<std::string_view> rows;
  for (const std::string& row : calibration.correlated) {
    if (!names.contains(row))
      report("correlated: " + Shown(row) + ": is no parameter of this file");
    if (!rows.insert(row).second) report("correlated: " + Shown(row) + ": stands twice");
  }
  if (calibration.correlated.size() > kMaxParameters) return;  // Then some are named above.
  const std::string wrong = WrongWith(calibration.correlated, calibration.covariance);
  if (!wrong.empty()) report("covariance " + wrong);
}

}  // namespace v2vouch
