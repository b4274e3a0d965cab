// SPDX-License-Identifier: Apache-2.0
#include "sim/radio/relay.h"

#include <algorithm>
#include <utility>

#include "sim/radio/envelope.h"

namespace v2vouch::sim {
namespace {

constexpr double kEgoCentre_m = 1.35;  // Ahead of the rear axle; metres do not matter to a radio.

bool IsBetween(const Box& box, const Vec2& a, const Vec2& b) {
  const auto corners = box.Corners();
  return LineCrossesOutline(a, b, {corners.begin(), corners.end()});
}

}  // namespace

Relay::Relay(RadioConfig config, std::uint64_t seed) : config_(std::move(config)), seed_(seed) {}

void Relay::OnTruth(const truth_list_t& truth) {
  vehicles_.clear();
  const Vec2 axle(truth.ego_x_m, truth.ego_y_m);
  vehicles_[0] = {
      {axle + kEgoCentre_m * Direction(truth.ego_yaw_rad), truth.ego_yaw_rad, 4.7, 1.85}, false};
  for (const truth_object_t& object : truth.objects) {
    vehicles_[object.id] = {
        {{object.x_m, object.y_m}, object.yaw_rad, object.length_m, object.width_m},
        object.height_m >= config_.tall_m};
  }
}

bool Relay::IsBlocked(std::int64_t from, std::int64_t to) const {
  const Vec2 a = vehicles_.at(from).box.centre;
  const Vec2 b = vehicles_.at(to).box.centre;
  for (const auto& [id, vehicle] : vehicles_) {
    if (vehicle.is_tall && id != from && id != to && IsBetween(vehicle.box, a, b)) return true;
  }
  return std::ranges::any_of(config_.obstacles, [&](const RadioObstacleSpec& o) {
    return IsBetween({{o.x_m, o.y_m}, o.yaw_rad, o.length_m, o.width_m}, a, b);
  });
}

void Relay::OnDatagram(std::size_t car, std::span<const std::uint8_t> bytes, std::int64_t utime) {
  ++figures_.sent;
  const std::int64_t from = config_.cars.at(car).id;
  for (std::size_t other = 0; other < config_.cars.size(); ++other) {
    const RadioCarSpec& listener = config_.cars[other];
    if (other == car || listener.deliver.empty()) continue;
    ++figures_.links;
    if (!vehicles_.contains(from) || !vehicles_.contains(listener.id)) {
      ++figures_.nowhere;
      continue;
    }
    const bool is_blocked = IsBlocked(from, listener.id);
    figures_.blocked += is_blocked ? 1 : 0;
    const double distance_m =
        (vehicles_.at(from).box.centre - vehicles_.at(listener.id).box.centre).norm();
    Link& link =
        links_
            .try_emplace({car, other}, config_.link, seed_, static_cast<std::uint64_t>(from),
                         static_cast<std::uint64_t>(listener.id))
            .first->second;
    const Link::Outcome outcome = link.Carry(utime, distance_m, is_blocked);
    if (outcome.fate == Link::Fate::kTooFar) ++figures_.too_far;
    if (outcome.fate == Link::Fate::kInterference) ++figures_.interference;
    if (outcome.fate == Link::Fate::kHeard) ++figures_.heard;
    for (const Link::Copy& copy : outcome.copies) {
      ++figures_.copies;
      Delivery delivery{utime + copy.delay_us, other, {bytes.begin(), bytes.end()}};
      if (listener.radiotap) delivery.bytes = RadioPacket(bytes, copy.signal_dbm);
      waiting_.insert({std::move(delivery), ++number_});
    }
  }
}

std::optional<Relay::Delivery> Relay::Next(std::int64_t utime) {
  if (waiting_.empty() || waiting_.begin()->delivery.utime > utime) return std::nullopt;
  return std::move(waiting_.extract(waiting_.begin()).value().delivery);
}

std::optional<std::int64_t> Relay::due() const {
  if (waiting_.empty()) return std::nullopt;
  return waiting_.begin()->delivery.utime;
}

}  // namespace v2vouch::sim
