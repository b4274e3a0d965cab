// SPDX-License-Identifier: Apache-2.0
#include "sim/sensors/bsm.h"

#include <algorithm>
#include <cmath>

#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

std::int32_t Rounded(double value, double unit, double low, double high) {
  return static_cast<std::int32_t>(std::llround(std::clamp(value / unit, low, high)));
}

constexpr double kDeviceBehind_m = 30.0;
constexpr double kPair_s = 0.05;
constexpr double kLong_m = 10.0;  // Vehicles that BsmSpec::long_reference_m is about.

// A unit signs after most of its delay has passed; the rest is the radio.
constexpr double kSignedAfter = 0.8;

// Free-space loss at 5.9 GHz: 20 log10(4 pi f / c) = 47.9 dB at 1 m.
double PathLoss_db(double distance_m) {
  return 47.9 + 20.0 * std::log10(std::max(1.0, distance_m));
}

struct Channel {
  double loss;
  double rssi_dbm;
};

Channel Between(const World& world, const Snapshot& snapshot, const Vec2& sender,
                std::uint32_t sender_id) {
  const RadioSpec& radio = world.scenario().radio;
  const Vec2 receiver =
      snapshot.ego.PointAt(world.vehicle().antenna_x_m, world.vehicle().antenna_y_m);
  double factor = 1.0;
  for (const Wall& wall : world.walls()) {
    if (LineCrossesOutline(receiver, sender, wall.outline)) {
      factor *= radio.building_factor;
      break;
    }
  }
  for (const ActorState& other : snapshot.actors) {
    if (other.actor->id == sender_id || other.actor->size.height_m < 2.5) continue;
    const auto corners = other.box().Corners();
    if (LineCrossesOutline(receiver, sender, {corners.begin(), corners.end()})) {
      factor *= radio.vehicle_factor;
      break;
    }
  }
  const double distance = factor * (sender - receiver).norm();
  const double by_distance =
      1.0 / (1.0 + std::exp((radio.half_range_m - distance) / radio.range_slope_m));
  return {radio.base_loss + (1.0 - radio.base_loss) * by_distance,
          radio.tx_power_dbm - PathLoss_db(distance)};
}

Statement StatementOfEgo(const VehicleConfig& vehicle, const EgoTruth& ego) {
  Statement said;
  said.centre = ego.PointAt(vehicle.centre_x_m, 0.0);
  said.yaw_rad = ego.yaw_rad;
  said.speed_mps = ego.speed_mps;
  said.accel_mps2 = ego.accel_mps2;
  said.yaw_rate_radps = ego.yaw_rate_radps;
  said.length_m = vehicle.length_m;
  said.width_m = vehicle.width_m;
  return said;
}

Statement StatementOf(const Actor& actor, double time_s) {
  Statement said;
  const Motion motion = actor.trajectory.At(time_s);
  said.centre = motion.centre;
  said.yaw_rad = motion.yaw_rad;
  said.speed_mps = motion.speed_mps;
  said.accel_mps2 = motion.accel_mps2;
  said.yaw_rate_radps = motion.yaw_rate_radps;
  said.length_m = actor.size.length_m;
  said.width_m = actor.size.width_m;
  return said;
}

double ReportedAccuracy(const SenderSpec& sender, const BsmSpec& spec, const Vec2& burst) {
  double semi_major_m = 0.0;
  const GnssErrorSpec& e = spec.gnss;
  if (sender.semi_major_m > 0.0) {
    semi_major_m = sender.semi_major_m;
  } else if (spec.semi_major_m > 0.0) {
    semi_major_m = spec.semi_major_m;
  } else {
    semi_major_m = std::sqrt(e.bias_sigma_m * e.bias_sigma_m + e.markov_sigma_m * e.markov_sigma_m +
                             e.white_sigma_m * e.white_sigma_m);
  }
  return spec.bursts.is_reported ? std::hypot(semi_major_m, burst.norm()) : semi_major_m;
}

}  // namespace

void Quantise(const SenderState& state, bsm_t& bsm) {
  // secMark: milliseconds within the UTC minute of the position's time.
  bsm.secMark = static_cast<std::int32_t>((state.position_utime / 1000) % 60000);
  bsm.lat = Rounded(state.latitude_deg, 1e-7, -9e8, 9e8);
  bsm.long_ = Rounded(state.longitude_deg, 1e-7, -1799999999.0, 1.8e9);
  bsm.elev = Rounded(state.elevation_m, 0.1, -4095.0, 61439.0);
  const bool has_accuracy = !std::isnan(state.semi_major_m);
  bsm.semiMajor =
      static_cast<std::int16_t>(has_accuracy ? Rounded(state.semi_major_m, 0.05, 0.0, 254.0) : 255);
  bsm.semiMinor = bsm.semiMajor;
  bsm.orientation = has_accuracy ? 0 : 65535;
  bsm.transmission = state.speed_mps < -0.05 ? 3 : 2;
  bsm.speed = static_cast<std::int16_t>(Rounded(std::abs(state.speed_mps), 0.02, 0.0, 8190.0));
  bsm.heading = Rounded(ToDegrees(state.heading_rad), 0.0125, 0.0, 28800.0) % 28800;
  bsm.angle = 127;
  bsm.accelSet_long =
      static_cast<std::int16_t>(Rounded(state.accel_long_mps2, 0.01, -2000.0, 2000.0));
  bsm.accelSet_lat =
      static_cast<std::int16_t>(Rounded(state.accel_lat_mps2, 0.01, -2000.0, 2000.0));
  bsm.accelSet_vert = -127;
  bsm.accelSet_yaw = Rounded(ToDegrees(-state.yaw_rate_radps), 0.01, -32767.0, 32767.0);
  const bool brakes = state.brakes == Brakes::kByDeceleration ? state.accel_long_mps2 < -0.8
                                                              : state.brakes == Brakes::kOn;
  bsm.wheelBrakes = brakes ? 0b01111 : 0;
  bsm.traction = 2;
  bsm.abs = 2;
  bsm.scs = 2;
  bsm.brakeBoost = 1;
  bsm.auxBrakes = 1;
  bsm.width = static_cast<std::int16_t>(Rounded(state.width_m, 0.01, 1.0, 1023.0));
  bsm.length = static_cast<std::int16_t>(Rounded(state.length_m, 0.01, 1.0, 4095.0));
}

Identity IdentityOf(std::uint64_t seed, std::uint32_t device, int number) {
  Random random = SubjectRandom(seed, "identity", {device, static_cast<std::uint64_t>(number)});
  Identity identity;
  std::uint64_t bits = random.Bits();
  for (auto& octet : identity.id) {
    octet = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
  bits = random.Bits();
  for (auto& octet : identity.certificate) {
    octet = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
  return identity;
}

int IdentityNumber(const SenderSpec& sender, double time_s) {
  return sender.identity_change_s > 0.0 && time_s >= sender.identity_change_s ? 1 : 0;
}

BsmSender::BsmSender(const World& world, int actor, std::uint64_t seed)
    : BsmSender(world, actor, actor < 0 ? 0 : world.actors()[static_cast<std::size_t>(actor)].id,
                seed) {}

BsmSender BsmSender::Device(const World& world, std::uint32_t device, std::uint64_t seed) {
  return {world, -1, device, seed};
}

BsmSender::BsmSender(const World& world, int actor, std::uint32_t subject, std::uint64_t seed)
    : world_(world),
      actor_(actor),
      subject_(subject),
      sender_(actor < 0 ? SenderSpec{} : world.actors()[static_cast<std::size_t>(actor)].sender),
      seed_(seed),
      writer_(world.scenario()),
      errors_(SubjectRandom(seed, "sender errors", {subject_})),
      position_(world.scenario().bsm.gnss, sender_.noise_scale,
                SubjectRandom(seed, "sender gnss", {subject_})),
      speed_(sender_.noise_scale * world.scenario().bsm.speed_markov_mps,
             world.scenario().bsm.gnss.markov_time_s, errors_),
      heading_(sender_.noise_scale * world.scenario().bsm.heading_markov_rad,
               world.scenario().bsm.gnss.markov_time_s, errors_),
      bursts_(world.scenario().bsm.bursts, SubjectRandom(seed, "sender bursts", {subject_})),
      gaps_(world.scenario().radio, SubjectRandom(seed, "sender gaps", {subject_})) {
  Random start = SubjectRandom(seed, "sender start", {subject_});
  const double rate = sender_.rate_hz > 0.0 ? sender_.rate_hz : world.scenario().bsm.rate_hz;
  phase_s_ = start.Uniform() / rate;
  first_msg_count_ = static_cast<int>(start.Uniform() * 128.0);
  Advance();
}

void BsmSender::Advance() {
  const BsmSpec& spec = world_.scenario().bsm;
  if (is_second_) {
    next_time_s_ += kPair_s;
    return;
  }
  const double rate = sender_.rate_hz > 0.0 ? sender_.rate_hz : spec.rate_hz;
  Random random =
      SubjectRandom(seed_, "sender clock", {subject_, static_cast<std::uint64_t>(tick_)});
  next_time_s_ = phase_s_ + static_cast<double>(tick_) / rate +
                 random.Uniform(-spec.period_jitter_s, spec.period_jitter_s);
  next_time_s_ = std::max(0.0, next_time_s_);
}

BsmSender::Draws BsmSender::DrawErrors(std::int64_t number, double dt_s) {
  const BsmSpec& spec = world_.scenario().bsm;
  Draws draws;
  draws.position = position_.Step(dt_s);
  draws.speed_mps = speed_.Step(dt_s, errors_);
  draws.heading_rad = heading_.Step(dt_s, errors_);
  Random random = SubjectRandom(seed_, "bsm", {subject_, static_cast<std::uint64_t>(number)});
  draws.speed_noise_mps = random.Normal(0.0, sender_.noise_scale * spec.speed_white_mps);
  draws.heading_noise_rad = random.Normal(0.0, sender_.noise_scale * spec.heading_white_rad);
  draws.latency_s =
      sender_.latency_scale * (spec.latency_s + spec.latency_spread_s * random.Uniform());
  draws.luck = random.Uniform();
  draws.fading_db = random.Normal(0.0, 2.0);
  return draws;
}

std::optional<Message> BsmSender::NextMessage() {
  const BsmSpec& spec = world_.scenario().bsm;
  const double time = next_time_s_;
  const std::int64_t number = count_++;
  const double dt = std::max(1e-3, time - last_time_s_);
  last_time_s_ = time;
  is_second_ = !is_second_ && spec.pair_share > 0.0 &&
               SubjectRandom(seed_, "pair", {subject_, static_cast<std::uint64_t>(number)})
                   .Bernoulli(spec.pair_share);
  if (!is_second_) ++tick_;
  Advance();

  // Errors move on with every message, sent or lost, so that loss changes nothing else.
  const Draws draws = DrawErrors(number, dt);
  const Snapshot snapshot = world_.At(time);
  Message message;
  Statement& said = message.said;
  Vec2 radio;  // Where the antenna is.
  if (actor_ < 0) {
    said = StatementOfEgo(world_.vehicle(), snapshot.ego);
    radio = is_device() ? snapshot.ego.PointAt(-kDeviceBehind_m, 0.0) : said.centre;
  } else {
    const Actor& actor = world_.actors()[static_cast<std::size_t>(actor_)];
    const double then = time - spec.position_age_s - sender_.position_age_s;
    if (!actor.trajectory.Exists(time) || !actor.trajectory.Exists(then)) return std::nullopt;
    said = StatementOf(actor, then);
    radio = said.centre;
  }
  const Channel channel = Between(world_, snapshot, radio, subject_);
  const Vec2 bias(sender_.bias_east_m, sender_.bias_north_m);
  const Vec2 burst = bursts_.At(time);
  said.time_s = time;
  message.error = bias + draws.position.horizontal + burst;
  said.centre = said.centre + bias + draws.position.horizontal + burst;
  if (said.length_m > kLong_m) said.centre += spec.long_reference_m * Direction(said.yaw_rad);
  said.height_m = draws.position.height_m;
  said.accel_lat_mps2 = said.speed_mps * said.yaw_rate_radps;
  const bool stands = std::abs(said.speed_mps) < 0.3;
  if (!stands || !has_heading_) {  // A standing receiver holds its last heading.
    held_yaw_rad_ = said.yaw_rad + draws.heading_rad + draws.heading_noise_rad;
    has_heading_ = true;
  }
  said.yaw_rad = held_yaw_rad_;
  said.speed_mps = stands ? 0.0 : said.speed_mps + draws.speed_mps + draws.speed_noise_mps;
  said.semi_major_m = ReportedAccuracy(sender_, spec, burst);
  message.time_s = time;
  message.stamp_s = time;
  message.signed_s = time;
  message.signed_after_s = kSignedAfter * draws.latency_s;
  message.latency_s = draws.latency_s;
  message.identity = IdentityOf(seed_, subject_, IdentityNumber(sender_, time));
  message.msg_count = static_cast<int>((first_msg_count_ + number) % 128);
  message.rssi_dbm = channel.rssi_dbm + draws.fading_db;
  message.loss = channel.loss;
  message.is_lost = draws.luck < channel.loss || gaps_.IsSilent(time);
  message.device = subject_;
  message.vehicle = subject_;
  message.honest = said;
  return message;
}

std::optional<bsm_t> BsmSender::Next() {
  const auto message = NextMessage();
  if (!message || message->is_lost) return std::nullopt;
  return writer_.Encode(*message);
}

}  // namespace v2vouch::sim
