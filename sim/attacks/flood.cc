// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/flood.h"

#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr double kLatency_s = 0.01;

template <class Octets>
void DrawOctets(Octets& octets, Random& random) {
  std::uint64_t bits = random.Bits();
  for (auto& octet : octets) {
    octet = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
}

// One value outside what SAE J2735 has for its field.
void Spoil(bsm_t& bsm, Random& random) {
  switch (static_cast<int>(random.Uniform() * 8.0)) {
    case 0:
      bsm.lat = 900000002;
      break;
    case 1:
      bsm.long_ = 1800000002;
      break;
    case 2:
      bsm.speed = 8192;
      break;
    case 3:
      bsm.heading = 28801;
      break;
    case 4:
      bsm.secMark = 65536;
      break;
    case 5:
      bsm.msgCnt = 128;
      break;
    case 6:
      bsm.accelSet_long = 2002;
      break;
    default:
      bsm.accelSet_yaw = 32768;
      break;
  }
}

}  // namespace

Flood::Flood(const AttackSpec& attack, const World& world, std::uint32_t device, std::uint64_t seed)
    : world_(world),
      spec_(*attack.path.flood),
      writer_(world.scenario()),
      gate_(attack.when),
      random_(SubjectRandom(seed, "flood", {device})) {}

RawMessage Flood::Make(double time_s) {
  const EgoTruth ego = world_.At(time_s).ego;
  Message message;
  message.time_s = time_s;
  message.stamp_s = time_s;
  message.signed_s = time_s;
  message.latency_s = kLatency_s;
  Statement& said = message.said;
  const double east = random_.Uniform(-spec_.radius_m, spec_.radius_m);
  const double north = random_.Uniform(-spec_.radius_m, spec_.radius_m);
  said.time_s = time_s;
  said.centre = ego.axle + Vec2(east, north);
  said.yaw_rad = random_.Uniform(-kPi, kPi);
  said.speed_mps = random_.Uniform(0.0, 30.0);
  DrawOctets(message.identity.id, random_);
  DrawOctets(message.identity.certificate, random_);
  message.msg_count = static_cast<int>(random_.Uniform() * 128.0);
  message.rssi_dbm = random_.Uniform(-90.0, -50.0);
  RawMessage raw{writer_.Encode(message), false};
  if (spec_.content == FloodSpec::Content::kMalformed) {
    raw.is_cut = random_.Bernoulli(0.2);
    if (!raw.is_cut) Spoil(raw.bsm, random_);
  }
  return raw;
}

void Flood::Run(double until_s, std::vector<RawMessage>& sent) {
  for (;; ++next_) {
    const double time = static_cast<double>(next_) / spec_.per_s;
    if (time >= until_s) return;
    if (gate_.Update({time, 0.0, 0, world_.At(time).ego.speed_mps, {}, nullptr})) {
      sent.push_back(Make(time));
    }
  }
}

}  // namespace v2vouch::sim
