// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/v2v/intake/honest_sender.h"

#include <algorithm>
#include <cmath>

#include "daemon/common/base/random.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

constexpr double kStep_s = 0.01;

struct Moment {
  double east_m = 0.0;
  double north_m = 0.0;
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
};

// One manoeuvre after another; each aims at a speed with an acceleration and turns by an angle.
std::vector<Moment> Drive(double duration_s, bool is_moving, Random& random) {
  std::vector<Moment> drive;
  Moment now{-100.0, 40.0, random.Uniform(-kPi, kPi), 0.0};
  double aim_mps = 10.0;
  double accel = 2.0;
  double turn_rad = 0.0;
  double left_s = 5.0;
  while (static_cast<double>(drive.size()) * kStep_s < duration_s) {
    drive.push_back(now);
    if (!is_moving) continue;
    left_s -= kStep_s;
    if (left_s <= 0.0) {
      const double dice = random.Uniform();
      left_s = random.Uniform(3.0, 8.0);
      accel = random.Uniform(1.0, 3.0);
      turn_rad = 0.0;
      if (dice < 0.15) {  // Stop, hard one time in three.
        aim_mps = 0.0;
        accel = random.Bernoulli(0.33) ? 8.0 : 3.0;
        left_s = random.Uniform(4.0, 10.0);
      } else if (dice < 0.40) {  // Turn left or right.
        aim_mps = random.Uniform(4.0, 8.0);
        accel = 4.0;
        turn_rad = random.Bernoulli(0.5) ? kPi / 2.0 : -kPi / 2.0;
      } else if (dice < 0.45) {  // U-turn.
        aim_mps = 5.0;
        accel = 4.0;
        turn_rad = kPi;
      } else if (dice < 0.50) {  // Back up.
        aim_mps = -2.5;
        accel = 3.0;
      } else {
        aim_mps = random.Uniform(8.0, 30.0);
      }
    }
    const double change = std::clamp(aim_mps - now.speed_mps, -accel * kStep_s, accel * kStep_s);
    now.speed_mps += change;
    // Turns begin once it is slow enough, at up to 5 m/s^2 sideways.
    const bool is_slow = std::abs(now.speed_mps - aim_mps) < 0.5 && std::abs(aim_mps) > 1.0;
    if (turn_rad != 0.0 && is_slow) {
      const double rate = std::min(0.7, 5.0 / std::abs(now.speed_mps)) * kStep_s;
      const double turn = std::clamp(turn_rad, -rate, rate);
      now.yaw_rad += turn;
      turn_rad -= turn;
      left_s = std::max(left_s, 0.5);
    }
    now.east_m += now.speed_mps * kStep_s * std::cos(now.yaw_rad);
    now.north_m += now.speed_mps * kStep_s * std::sin(now.yaw_rad);
    // Keep near the crossroads, as in a town.
    if (std::hypot(now.east_m, now.north_m) > 800.0) {
      now.east_m *= -0.5;
      now.north_m *= -0.5;
      drive.clear();
    }
  }
  return drive;
}

}  // namespace

std::vector<Bsm> HonestMessages(const HonestErrors& errors, double duration_s, std::uint64_t seed) {
  Random random = Random::ForSubject(seed, 77);
  const std::vector<Moment> drive = Drive(duration_s + 1.0, errors.is_moving, random);
  std::vector<Bsm> messages;
  double bias_east = random.Normal(0.0, errors.bias_sigma_m);
  double bias_north = random.Normal(0.0, errors.bias_sigma_m);
  double step_east = 0.0;
  const double lasting = std::sqrt(0.5);
  const double speed_error = lasting * random.Normal(0.0, errors.speed_sigma_mps);
  const double course_error = lasting * random.Normal(0.0, errors.course_sigma_deg);
  double held_course_rad = 0.0;
  int count = 0;
  double time_s = 0.5;
  const auto send = [&](double at_s) {
    const double kept = std::exp(-1.0 / (errors.rate_hz * errors.bias_time_s));
    const double fresh = errors.bias_sigma_m * std::sqrt(1.0 - kept * kept);
    bias_east = kept * bias_east + random.Normal(0.0, fresh);
    bias_north = kept * bias_north + random.Normal(0.0, fresh);
    const double in_half_minute = std::fmod(at_s, 30.0);
    if (in_half_minute < 1.0 / errors.rate_hz) step_east = errors.step_m - step_east;
    const double place_s = at_s - random.Uniform(0.0, errors.stale_s);
    const auto index = [&](double t) {
      return static_cast<std::size_t>(std::max(0.0, t / kStep_s));
    };
    const Moment& place = drive[index(place_s)];
    const Moment& now = drive[index(at_s)];
    TalkingCar car;
    car.id = static_cast<SenderId>(1000 + seed);
    car.time_s = at_s;
    car.msg_count = count++ % 128;
    car.latency_s = errors.latency_s + random.Uniform(0.0, errors.latency_spread_s);
    const double from_edge_s = std::min(in_half_minute - 20.0, 25.0 - in_half_minute);
    const double burst = from_edge_s <= 0.0 ? 0.0
                         : from_edge_s < errors.burst_rise_s
                             ? errors.burst_m * from_edge_s / errors.burst_rise_s
                             : errors.burst_m;
    car.east_m = place.east_m + bias_east + step_east + random.Normal(0.0, errors.white_m);
    car.north_m = place.north_m + bias_north + burst + random.Normal(0.0, errors.white_m);
    const bool stands = std::abs(now.speed_mps) < 0.3;
    const double speed_noise = lasting * random.Normal(0.0, errors.speed_sigma_mps);
    const double course_noise = lasting * random.Normal(0.0, errors.course_sigma_deg);
    car.speed_mps = stands ? 0.0 : now.speed_mps + speed_error + speed_noise;
    if (!stands) held_course_rad = now.yaw_rad + FromDegrees(course_error + course_noise);
    Bsm bsm = car.Say();
    const bool is_reverse = now.speed_mps < -0.05;
    if (is_reverse) bsm.transmission = Transmission::kReverse;
    bsm.course_rad = WrapAngle(held_course_rad + (is_reverse ? kPi : 0.0));
    bsm.semi_major_m = std::hypot(errors.accuracy_m, errors.is_burst_reported ? burst : 0.0);
    const bool is_in_gap = in_half_minute > 5.0 && in_half_minute < 5.0 + errors.gap_s;
    if (!random.Bernoulli(errors.loss) && !is_in_gap) messages.push_back(bsm);
  };
  while (time_s < duration_s) {
    send(time_s);
    if (random.Bernoulli(errors.pair_share)) send(time_s + 0.05);
    time_s += 1.0 / errors.rate_hz;
  }
  std::ranges::stable_sort(messages, {}, &Bsm::stamp);
  return messages;
}

}  // namespace v2vouch
