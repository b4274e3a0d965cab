// SPDX-License-Identifier: Apache-2.0
// Calibrated values in the place of configured ones.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/calibration_file/calibration_file.h"
#include "daemon/rim/config/bounds_text.h"
#include "daemon/rim/config/number_text.h"

namespace v2vouch {
namespace {

constexpr double kMostPriorStds = 3.0;

// The archive that finds one number of a config struct by its key (base/visit.h): the list that
// reads the configuration is the list of what a calibration may set, with the same bounds.
class NumberFinder {
 public:
  explicit NumberFinder(std::string_view key) : key_(key) {}

  template <class T>
  void Field(std::string_view key, T& value, const Bounds& bounds = {}) {
    if constexpr (std::is_same_v<T, double>) {
      if (key == key_) number_ = {&value, bounds, false};
    }
  }
  void Degrees(std::string_view key, double& radians, const Bounds& bounds = {}) {
    if (key == key_) number_ = {&radians, bounds, true};
  }
  void Text(const char*, std::string&) {}
  template <class E>
  void Choice(const char*, E&,
              std::initializer_list<std::pair<const char*, std::type_identity_t<E>>>) {}

  struct Number {
    double* value = nullptr;
    Bounds bounds{};
    bool is_angle = false;

    [[nodiscard]] double Get() const { return is_angle ? ToDegrees(*value) : *value; }
    void Set(double to) const { *value = is_angle ? FromDegrees(to) : to; }
    /// How far `from` is away, the short way round.
    [[nodiscard]] double Distance(double from) const {
      return is_angle ? std::abs(ToDegrees(WrapAngle(FromDegrees(from) - *value)))
                      : std::abs(from - *value);
    }
  };
  [[nodiscard]] const Number& number() const { return number_; }

 private:
  std::string_view key_;
  Number number_;
};

template <class Settings>
NumberFinder::Number NumberOf(Settings& settings, std::string_view key) {
  NumberFinder finder(key);
  settings.Visit(finder);
  return finder.number();
}

// The one sensor called so. @return nullptr where there is none, or more than one.
template <class Sensor>
Sensor* SensorCalled(std::vector<Sensor>& sensors, std::string_view name, std::string& problem) {
  Sensor* found = nullptr;
  for (Sensor& sensor : sensors) {
    if (LowerCaseName(sensor.name) != name) continue;
    if (found != nullptr) problem = "two sensors of this vehicle are called so in lower case";
    found = &sensor;
  }
  if (found == nullptr) {
    std::vector<std::string> names;
    for (const Sensor& sensor : sensors) names.push_back(LowerCaseName(sensor.name));
    problem = "this vehicle has no such sensor" + DidYouMean(name, names);
  }
  return problem.empty() ? found : nullptr;
}

// The last parts of all names that calibrations know.
const std::vector<std::string> kKeys = {"x_m",
                                        "y_m",
                                        "z_m",
                                        "yaw_deg",
                                        "pitch_deg",
                                        "roll_deg",
                                        "range_offset_m",
                                        "clock_offset_s",
                                        "antenna_x_m",
                                        "antenna_y_m",
                                        "heading_bias_deg",
                                        "speed_scale",
                                        "yaw_rate_bias_degps",
                                        "odometer_y_m",
                                        "slip_s2pm"};

struct Target {
  NumberFinder::Number number;
  bool is_mount = false;  // A place or an angle that was measured when the part was mounted.
  bool is_told_only = false;
  std::string problem;
};

Target TargetOf(std::string_view name, VehicleConfig& vehicle) {
  constexpr std::string_view kRadar = "radar_";
  constexpr std::string_view kCamera = "camera_";
  const auto dot = std::min(name.rfind('.'), name.size());
  const std::string_view owner = name.substr(0, dot);
  const std::string_view key = dot < name.size() ? name.substr(dot + 1) : std::string_view{};
  Target target;
  if (owner == "ego") {
    target.is_told_only = key == "odometer_y_m" || key == "slip_s2pm";
    target.is_mount = key == "antenna_x_m" || key == "antenna_y_m";
    target.number = NumberOf(vehicle, key);
  } else if (owner.starts_with(kRadar)) {
    target.is_mount = true;
    auto* radar = SensorCalled(vehicle.radars, owner.substr(kRadar.size()), target.problem);
    if (radar != nullptr) target.number = NumberOf(*radar, key);
  } else if (owner.starts_with(kCamera)) {
    target.is_mount = true;
    auto* camera = SensorCalled(vehicle.cameras, owner.substr(kCamera.size()), target.problem);
    if (camera != nullptr) target.number = NumberOf(*camera, key);
  }
  if (target.problem.empty() && !target.is_told_only && target.number.value == nullptr) {
    target.problem = "unknown name" + DidYouMean(key, kKeys);
  }
  return target;
}

}  // namespace

bool ApplyCalibration(const CalibrationFile& calibration, VehicleConfig& vehicle,
                      std::vector<std::string>& problems) {
  const std::size_t before = problems.size();
  const auto report = [&](const std::string& what) { problems.push_back(what); };
  if (!calibration.vehicle_id.empty() && !vehicle.id.empty() &&
      calibration.vehicle_id != vehicle.id) {
    report("is for vehicle \"" + calibration.vehicle_id + "\", this one is \"" + vehicle.id + "\"");
  }
  VehicleConfig calibrated = vehicle;
  for (const CalibratedParameter& parameter : calibration.parameters) {
    const Target target = TargetOf(parameter.name, calibrated);
    const NumberFinder::Number& number = target.number;
    const std::string value = parameter.name + " = " + config::NumberText(parameter.value) + ": ";
    if (!target.problem.empty()) {
      report(parameter.name + ": " + target.problem);
    } else if (target.is_told_only || !IsApplied(parameter.verdict)) {
      continue;
    } else if (!std::isfinite(parameter.value) ||
               !config::AreKept(number.bounds, parameter.value)) {
      report(value + config::BoundsText(number.bounds));
    } else if (target.is_mount &&
               !(number.Distance(parameter.value) <= kMostPriorStds * parameter.prior_std)) {
      report(value + "farther from the configured " + config::NumberText(number.Get()) +
             " than 3 prior_std of " + config::NumberText(parameter.prior_std) +
             "; is it another mount? Measure it, correct the configuration, calibrate again");
    } else {
      number.Set(parameter.value);
    }
  }
  if (problems.size() > before) return false;
  vehicle = std::move(calibrated);
  return true;
}

}  // namespace v2vouch
