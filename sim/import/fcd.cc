// SPDX-License-Identifier: Apache-2.0
#include "sim/import/fcd.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string_view>

#include "daemon/common/base/angle.h"
#include "sim/import/csv.h"

namespace v2vouch::sim {
namespace {

constexpr double kMaxGap_s = 1.0;
constexpr double kMaxSpeed_mps = 80.0;  // Faster between two rows is a teleport.
constexpr double kLaneJump_m = 1.0;     // Sideways in one step; a lane is 3 m.
constexpr double kLaneChangeLength_m = 20.0;
constexpr double kSmoothing_s = 1.2;
constexpr int kTowSteps = 8;             // Per row.
constexpr double kRearAxleShare = 0.78;  // Front bumper to rear axle over length, of a car.

Eigen::Vector2d Direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }
Eigen::Vector2d LeftOf(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

bool Continues(const FcdSample& last, const FcdSample& next) {
  const double dt_s = next.time_s - last.time_s;
  return dt_s <= kMaxGap_s && (next.front - last.front).norm() <= kMaxSpeed_mps * dt_s + 5.0;
}

// 0 below -0.5, 1 above 0.5, smooth between.
double SmoothStep(double u) {
  const double v = std::clamp(u + 0.5, 0.0, 1.0);
  return v * v * (3.0 - 2.0 * v);
}

// The bumper's way with lane changes driven instead of jumped.
std::vector<Eigen::Vector2d> SpreadLaneChanges(const std::vector<FcdSample>& samples) {
  struct Jump {
    double at_m;
    Eigen::Vector2d sideways;
  };
  std::vector<Jump> jumps;
  std::vector<double> driven_m(samples.size(), 0.0);
  std::vector<Eigen::Vector2d> way{samples.front().front};
  Eigen::Vector2d removed = Eigen::Vector2d::Zero();
  for (std::size_t k = 1; k < samples.size(); ++k) {
    const Eigen::Vector2d step = samples[k].front - samples[k - 1].front;
    const Eigen::Vector2d left = LeftOf(Direction(samples[k - 1].heading_rad));
    const double sideways_m = step.dot(left);
    double driven_step_m = step.norm();
    if (std::abs(sideways_m) > kLaneJump_m) {
      jumps.push_back({driven_m[k - 1], sideways_m * left});
      removed += sideways_m * left;
      driven_step_m = std::abs(step.dot(Direction(samples[k - 1].heading_rad)));
    }
    driven_m[k] = driven_m[k - 1] + driven_step_m;
    way.push_back(samples[k].front - removed);
  }
  for (std::size_t k = 0; k < way.size(); ++k) {
    for (const Jump& jump : jumps) {
      way[k] += jump.sideways * SmoothStep((driven_m[k] - jump.at_m) / kLaneChangeLength_m);
    }
  }
  return way;
}

// Weighted straight line through the neighbours of sample k in time, taken at k. Unlike a mean it
// does not pull the ends of the way inwards.
Eigen::Vector2d LocalLine(const std::vector<FcdSample>& samples,
                          const std::vector<Eigen::Vector2d>& way, std::size_t k) {
  double w0 = 0.0;
  double w1 = 0.0;
  double w2 = 0.0;
  Eigen::Vector2d p0 = Eigen::Vector2d::Zero();
  Eigen::Vector2d p1 = Eigen::Vector2d::Zero();
  const auto add = [&](std::size_t j) {
    const double dt_s = samples[j].time_s - samples[k].time_s;
    const double u = dt_s / kSmoothing_s;
    if (std::abs(u) >= 1.0) return false;
    const double weight = 1.0 - u * u;
    w0 += weight;
    w1 += weight * dt_s;
    w2 += weight * dt_s * dt_s;
    p0 += weight * way[j];
    p1 += weight * dt_s * way[j];
    return true;
  };
  for (std::size_t j = k; j < way.size() && add(j); ++j) {
  }
  for (std::size_t j = k; j > 0 && add(j - 1); --j) {
  }
  const double determinant = w0 * w2 - w1 * w1;
  if (determinant < 1e-12) return p0 / w0;
  return (w2 * p0 - w1 * p1) / determinant;
}

}  // namespace

std::vector<FcdVehicle> ReadFcd(const std::string& path, std::string& error) {
  const auto csv = CsvReader::Open(path,
                                   {"time_s", "id", "type", "lon_deg", "lat_deg", "x_m", "y_m",
                                    "heading_deg_cw_from_north", "speed_mps"},
                                   error);
  if (csv == nullptr) return {};
  std::vector<FcdVehicle> vehicles;
  std::map<std::string, std::size_t, std::less<>> present;  // SUMO id -> newest piece.
  while (csv->Next()) {
    FcdSample sample;
    sample.time_s = csv->Number(0);
    sample.longitude_deg = csv->Number(3);
    sample.latitude_deg = csv->Number(4);
    sample.front = {csv->Number(5), csv->Number(6)};
    sample.heading_rad = WrapAngle(FromDegrees(90.0 - csv->Number(7)));
    if (csv->Text(1).empty()) csv->Fail("id is empty");
    if (!csv->error().empty()) break;
    auto found = present.find(csv->Text(1));
    if (found != present.end()) {
      const FcdSample& last = vehicles[found->second].samples.back();
      if (sample.time_s <= last.time_s) {
        csv->Fail("time of this vehicle does not go forward");
        break;
      }
      if (!Continues(last, sample)) {
        present.erase(found);
        found = present.end();
      }
    }
    if (found == present.end()) {
      found = present.emplace(std::string(csv->Text(1)), vehicles.size()).first;
      vehicles.push_back({std::string(csv->Text(1)), std::string(csv->Text(2)), {}});
    }
    vehicles[found->second].samples.push_back(sample);
  }
  error = csv->error();
  if (error.empty() && vehicles.empty()) error = path + ": holds no row";
  if (!error.empty()) vehicles.clear();
  return vehicles;
}

FcdBody BodyOfType(const std::string& type) {
  std::string name = type;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto has = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  if (has("trailer")) return {ObjectClass::kTruck, 16.5, 2.55};
  if (has("truck") || has("lkw")) return {ObjectClass::kTruck, 7.1, 2.4};
  if (has("bus") || has("coach")) return {ObjectClass::kBus, 12.0, 2.5};
  if (has("motorcycle") || has("moped")) return {ObjectClass::kMotorcycle, 2.2, 0.9};
  if (has("delivery") || has("van")) return {ObjectClass::kVan, 6.5, 2.16};
  if (has("bicycle") || has("bike")) return {ObjectClass::kCyclist, 1.6, 0.65};
  return {};
}

std::vector<CentreSample> CentreMotion(const FcdVehicle& vehicle, const FcdBody& body) {
  const std::vector<FcdSample>& samples = vehicle.samples;
  const std::vector<Eigen::Vector2d> way = SpreadLaneChanges(samples);
  const double axle_m = kRearAxleShare * body.length_m;
  std::vector<CentreSample> motion;
  Eigen::Vector2d axle = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_front = Eigen::Vector2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Eigen::Vector2d front = LocalLine(samples, way, k);
    if (k == 0) {
      last_front = front;
      axle = front - axle_m * Direction(samples[0].heading_rad);
    }
    // Towed: the axle follows, but cannot slip sideways. One step per row would lag by half a row.
    for (int part = 1; part <= kTowSteps; ++part) {
      const Eigen::Vector2d hook =
          last_front + (front - last_front) * (static_cast<double>(part) / kTowSteps);
      pull = (hook - axle).normalized();
      axle = hook - axle_m * pull;
    }
    last_front = front;
    CentreSample sample;
    sample.time_s = samples[k].time_s;
    sample.centre = front - 0.5 * body.length_m * pull;
    const double yaw_rad = std::atan2(pull.y(), pull.x());
    const double before_rad = motion.empty() ? yaw_rad : motion.back().yaw_rad;
    sample.yaw_rad = before_rad + AngleDifference(yaw_rad, before_rad);
    motion.push_back(sample);
  }
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const std::size_t from = k > 0 ? k - 1 : 0;
    const std::size_t to = std::min(k + 1, motion.size() - 1);
    if (from == to) continue;
    const Eigen::Vector2d moved = motion[to].centre - motion[from].centre;
    motion[k].speed_mps =
        moved.dot(Direction(motion[k].yaw_rad)) / (motion[to].time_s - motion[from].time_s);
  }
  return motion;
}

}  // namespace v2vouch::sim
