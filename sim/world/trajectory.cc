// SPDX-License-Identifier: Apache-2.0
#include "sim/world/trajectory.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "daemon/common/data/object_class.h"

namespace v2vouch::sim {
namespace {

// Moving average over `2 half + 1` samples; the ends repeat.
template <class T>
std::vector<T> Averaged(const std::vector<T>& values, int half) {
  const int n = static_cast<int>(values.size());
  std::vector<T> result(values.size());
  for (int i = 0; i < n; ++i) {
    T sum = values[static_cast<std::size_t>(std::clamp(i - half, 0, n - 1))];
    for (int k = i - half + 1; k <= i + half; ++k) {
      sum = sum + values[static_cast<std::size_t>(std::clamp(k, 0, n - 1))];
    }
    result[static_cast<std::size_t>(i)] = sum * (1.0 / (2 * half + 1));
  }
  return result;
}

// 6 t^5 - 15 t^4 + 10 t^3: rises 0..1 with velocity and acceleration zero at both ends.
double SmoothStep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

// Fastest speed at every half metre that bends and the braking before them allow.
class SpeedLimit {
 public:
  SpeedLimit(const Path& path, const DriveSpec& drive) {
    const auto n = static_cast<std::size_t>(path.length_m() / kStep_m) + 2;
    limit_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double curvature = std::abs(path.At(static_cast<double>(i) * kStep_m).curvature_per_m);
      limit_[i] = std::sqrt(drive.lateral_mps2 / std::max(curvature, 1e-6));
    }
    for (std::size_t i = n - 1; i-- > 0;) {
      const double braking =
          std::sqrt(limit_[i + 1] * limit_[i + 1] + 2.0 * drive.decel_mps2 * kStep_m);
      limit_[i] = std::min(limit_[i], braking);
    }
  }

  [[nodiscard]] double At(double s_m) const {
    if (s_m < 0.0) return limit_.front();
    const auto i = static_cast<std::size_t>(s_m / kStep_m);
    return i < limit_.size() ? limit_[i] : 1e3;
  }

 private:
  static constexpr double kStep_m = 0.5;
  std::vector<double> limit_;
};

// The driver: where the axle is along the path.
class Driver {
 public:
  // @param front_m leading bumper ahead of the axle.
  Driver(const Path& path, const DriveSpec& drive, double place, double front_m)
      : place_(place), drive_(drive), limit_(path, drive), front_m_(front_m) {
    speed_ = std::min(Wish(0.0), Allowed(0.0));
  }

  [[nodiscard]] double place_m() const { return place_; }
  [[nodiscard]] double speed_mps() const { return speed_; }

  void Step(double time, double step_s) {
    const double wish = Wish(time);
    const double allowed = Allowed(time);
    // Wishes obey the driver's limits; bends and stops bind exactly.
    const double wished = wish > speed_ ? std::min(wish, speed_ + drive_.accel_mps2 * step_s)
                                        : std::max(wish, speed_ - drive_.decel_mps2 * step_s);
    speed_ = std::min(wished, allowed);
    place_ += speed_ * step_s;
  }

 private:
  // Fastest speed that bends and the next stop allow here and now.
  double Allowed(double time) {
    while (next_stop_ < drive_.stops.size() &&
           (time >= drive_.stops[next_stop_].until_s ||
            drive_.stops[next_stop_].at_m - front_m_ < place_ - 0.5)) {
      ++next_stop_;
    }
    if (next_stop_ == drive_.stops.size()) return limit_.At(place_);
    const double left = drive_.stops[next_stop_].at_m - front_m_ - place_;
    const double stopping = left <= 0.005 ? 0.0 : std::sqrt(2.0 * drive_.decel_mps2 * left);
    return std::min(limit_.At(place_), stopping);
  }
  [[nodiscard]] double Wish(double time) const {
    double wish = drive_.speed_mps;
    for (const SpeedSpec& later : drive_.speeds) {
      if (time >= later.from_s) wish = later.mps;
    }
    return wish;
  }

  double place_;
  double speed_ = 0.0;
  const DriveSpec& drive_;
  SpeedLimit limit_;
  double front_m_;
  std::size_t next_stop_ = 0;
};

}  // namespace

double LateralOffset(const DriveSpec& drive, double time_s) {
  double offset = drive.offset_m;
  for (const LaneChangeSpec& change : drive.lane_changes) {
    offset += (change.offset_m - offset) * SmoothStep((time_s - change.at_s) / change.over_s);
  }
  return offset;
}

Trajectory Trajectory::Drive(const Path& path, const DriveSpec& drive, double length_m,
                             double centre_ahead_m, double duration_s) {
  // Arc length of the axle every 10 ms, with a lead so that smoothing sees real motion on both
  // sides of the run.
  constexpr int kLead = 50;
  const int steps = static_cast<int>(std::ceil(duration_s / kStep_s)) + 1;
  // Along the way driven: backwards the rear bumper leads, and the axle is ahead of the centre.
  const double centre_m = drive.reverse ? -centre_ahead_m : centre_ahead_m;
  Driver driver(path, drive, drive.start_m - centre_m, centre_m + 0.5 * length_m);
  std::vector<double> s(static_cast<std::size_t>(steps + 2 * kLead));
  for (int i = 0; i < kLead; ++i) {  // Before the start.
    s[static_cast<std::size_t>(i)] = driver.place_m() + driver.speed_mps() * (i - kLead) * kStep_s;
  }
  for (int i = kLead; i < steps + 2 * kLead; ++i) {
    s[static_cast<std::size_t>(i)] = driver.place_m();
    driver.Step((i - kLead) * kStep_s, kStep_s);
  }
  // Two half-second averages: acceleration becomes continuous.
  s = Averaged(Averaged(s, kLead / 2), kLead / 2);

  Trajectory result;
  result.table_.resize(static_cast<std::size_t>(steps));
  for (int i = 0; i < steps; ++i) {
    const double time = i * kStep_s;
    const auto index = static_cast<std::size_t>(i + kLead);
    const double along_mps = (s[index + 1] - s[index - 1]) / (2.0 * kStep_s);
    const PathPoint point = path.At(s[index]);
    const double offset = LateralOffset(drive, time);
    const double offset_mps =
        (LateralOffset(drive, time + kStep_s) - LateralOffset(drive, time - kStep_s)) /
        (2.0 * kStep_s);
    Motion& motion = result.table_[static_cast<std::size_t>(i)];
    motion.yaw_rad = point.yaw_rad;
    if (along_mps > 0.1) {
      motion.yaw_rad += std::atan2(offset_mps, along_mps * (1.0 - point.curvature_per_m * offset));
    }
    motion.centre = point.position + offset * LeftOf(Direction(point.yaw_rad)) +
                    centre_m * Direction(motion.yaw_rad);
    if (drive.reverse) motion.yaw_rad += kPi;
  }
  result.Differentiate();
  return result;
}

Trajectory Trajectory::Follow(const std::vector<Row>& rows) {
  Trajectory result;
  result.start_s_ = rows.front().time_s;
  result.end_s_ = rows.back().time_s;
  std::vector<double> yaw(rows.size());
  yaw[0] = rows[0].yaw_rad;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    yaw[i] = yaw[i - 1] + AngleDifference(rows[i].yaw_rad, rows[i - 1].yaw_rad);
  }
  const auto steps =
      static_cast<std::size_t>(std::floor((result.end_s_ - result.start_s_) / kStep_s)) + 1;
  std::vector<Vec2> place(steps);
  std::vector<double> smooth_yaw(steps);
  std::size_t i = 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double time = result.start_s_ + static_cast<double>(k) * kStep_s;
    while (i + 2 < rows.size() && rows[i + 1].time_s <= time) ++i;
    const double span = rows[i + 1].time_s - rows[i].time_s;
    const double u = (time - rows[i].time_s) / span;
    // Cubic Hermite; slopes from the neighbouring rows (Catmull-Rom over uneven steps).
    const auto slope = [&](std::size_t j) -> Vec2 {
      const std::size_t a = j == 0 ? 0 : j - 1;
      const std::size_t b = std::min(j + 1, rows.size() - 1);
      return (rows[b].centre - rows[a].centre) / (rows[b].time_s - rows[a].time_s);
    };
    const double u2 = u * u;
    const double u3 = u2 * u;
    place[k] = (2 * u3 - 3 * u2 + 1) * rows[i].centre + (u3 - 2 * u2 + u) * span * slope(i) +
               (3 * u2 - 2 * u3) * rows[i + 1].centre + (u3 - u2) * span * slope(i + 1);
    smooth_yaw[k] = yaw[i] + u * (yaw[i + 1] - yaw[i]);
  }
  constexpr int kHalf = 25;
  place = Averaged(Averaged(place, kHalf), kHalf);
  smooth_yaw = Averaged(Averaged(smooth_yaw, kHalf), kHalf);
  result.table_.resize(steps);
  for (std::size_t k = 0; k < steps; ++k) {
    result.table_[k].centre = place[k];
    result.table_[k].yaw_rad = smooth_yaw[k];
  }
  result.Differentiate();
  return result;
}

Trajectory Trajectory::Stand(const Vec2& centre, double yaw_rad) {
  Trajectory result;
  Motion motion;
  motion.centre = centre;
  motion.yaw_rad = yaw_rad;
  result.table_.push_back(motion);
  return result;
}

void Trajectory::Differentiate() {
  const std::size_t n = table_.size();
  if (n < 2) return;
  const auto slope = [&](auto value, std::size_t i) {
    const std::size_t a = i == 0 ? 0 : i - 1;
    const std::size_t b = std::min(i + 1, n - 1);
    return decltype(value(i))((value(b) - value(a)) / (static_cast<double>(b - a) * kStep_s));
  };
  for (std::size_t i = 0; i < n; ++i) {
    table_[i].velocity = slope([&](std::size_t k) { return Vec2(table_[k].centre); }, i);
    table_[i].yaw_rate_radps = slope([&](std::size_t k) { return table_[k].yaw_rad; }, i);
    table_[i].speed_mps = table_[i].velocity.dot(Direction(table_[i].yaw_rad));
  }
  for (std::size_t i = 0; i < n; ++i) {
    table_[i].accel_mps2 = slope([&](std::size_t k) { return table_[k].speed_mps; }, i);
  }
}

Motion Trajectory::At(double time_s) const {
  const double exact =
      std::clamp((time_s - start_s_) / kStep_s, 0.0, static_cast<double>(table_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(exact), table_.size() - 1);
  const Motion& a = table_[i];
  if (i + 1 == table_.size()) return a;
  const Motion& b = table_[i + 1];
  const double u = exact - static_cast<double>(i);
  const auto mix = [u](const auto& from, const auto& to) { return from + u * (to - from); };
  Motion motion;
  motion.centre = mix(a.centre, b.centre);
  motion.velocity = mix(a.velocity, b.velocity);
  motion.yaw_rad = mix(a.yaw_rad, b.yaw_rad);
  motion.speed_mps = mix(a.speed_mps, b.speed_mps);
  motion.yaw_rate_radps = mix(a.yaw_rate_radps, b.yaw_rate_radps);
  motion.accel_mps2 = mix(a.accel_mps2, b.accel_mps2);
  return motion;
}

bool Trajectory::Exists(double time_s) const {
  return table_.size() == 1 || (time_s >= start_s_ && time_s <= end_s_);
}

bool LoadTrajectories(const std::string& path, std::map<std::uint32_t, Recorded>& vehicles,
                      std::vector<std::string>& problems) {
  std::ifstream file(path);
  if (!file) {
    problems.push_back(path + ": cannot be opened");
    return false;
  }
  static constexpr const char* kHeader =
      "time_s,id,class,x_m,y_m,yaw_rad,speed_mps,length_m,width_m";
  std::string line;
  if (!std::getline(file, line) || line != kHeader) {
    problems.push_back(path + ":1: the first line must be " + kHeader);
    return false;
  }
  for (int number = 2; std::getline(file, line); ++number) {
    if (line.empty()) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream text(line);
    double time = 0.0, x = 0.0, y = 0.0, yaw = 0.0, speed = 0.0, length = 0.0, width = 0.0;
    std::uint32_t id = 0;
    std::string name;
    text >> time >> id >> name >> x >> y >> yaw >> speed >> length >> width;
    const auto known = ObjectClassOf(name);
    Recorded& vehicle = vehicles[id];
    const bool ordered = vehicle.rows.empty() || time > vehicle.rows.back().time_s;
    if (!text || id == 0 || !known || !ordered || length <= 0.0 || width <= 0.0) {
      problems.push_back(path + ":" + std::to_string(number) +
                         ": not a row of increasing time with id above 0 and a known class");
      return false;
    }
    vehicle.object_class = *known;
    vehicle.length_m = length;
    vehicle.width_m = width;
    vehicle.rows.push_back({time, {x, y}, yaw});
  }
  std::erase_if(vehicles, [](const auto& entry) { return entry.second.rows.size() < 2; });
  return true;
}

}  // namespace v2vouch::sim
