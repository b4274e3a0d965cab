// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/priority/priority_list.h"

#include <algorithm>
#include <utility>

namespace v2vouch {

const PriorityVehicle* PriorityList::Of(SenderId sender) const {
  const auto at = std::ranges::find_if(vehicles_, [&](const PriorityVehicle& vehicle) {
    return vehicle.sender == sender && !vehicle.has_ended();
  });
  return at == vehicles_.end() ? nullptr : &*at;
}

PriorityVehicle* PriorityList::Of(SenderId sender) {
  return const_cast<PriorityVehicle*>(std::as_const(*this).Of(sender));
}

bool PriorityList::Holds(std::uint64_t local_id) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return !vehicle.has_ended() && vehicle.local_id == local_id;
  });
}

bool PriorityList::HoldsForAnother(std::uint64_t local_id, SenderId sender) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return !vehicle.has_ended() && vehicle.is_supported && vehicle.local_id == local_id &&
           vehicle.sender != sender;
  });
}

const PriorityVehicle* PriorityList::SupportedBy(std::uint64_t local_id) const {
  const auto at = std::ranges::find_if(vehicles_, [&](const PriorityVehicle& vehicle) {
    return !vehicle.has_ended() && vehicle.is_supported && vehicle.local_id == local_id;
  });
  return at == vehicles_.end() ? nullptr : &*at;
}

bool PriorityList::HasAnotherAt(const Eigen::Vector2d& p_O, SenderId but, bool is_supported) const {
  return std::ranges::any_of(vehicles_, [&](const PriorityVehicle& vehicle) {
    return !vehicle.has_ended() && vehicle.sender != but && vehicle.is_supported == is_supported &&
           (vehicle.filter.mean().head<2>() - p_O).norm() <= kOnePlace_m;
  });
}

std::uint64_t PriorityList::FreeId(std::uint64_t local_id) const {
  std::uint64_t id = PriorityId(local_id, 0);
  for (int attempt = 1; std::ranges::find(vehicles_, id, &PriorityVehicle::id) != vehicles_.end();
       ++attempt) {
    id = PriorityId(local_id, attempt);
  }
  return id;
}

void PriorityList::Add(const PriorityVehicle& vehicle) {
  vehicles_.insert(std::ranges::lower_bound(vehicles_, vehicle.id, {}, &PriorityVehicle::id),
                   vehicle);
}

void PriorityList::DropEnded() {
  std::erase_if(vehicles_, [](const PriorityVehicle& vehicle) { return vehicle.has_ended(); });
}

PublishedTrack LineOf(const PriorityVehicle& vehicle, Timestamp at,
                      const PriorityFilterConfig& filter, const BridgeConfig& bridge) {
  PublishedTrack line;
  LocalTrack& track = line.track;
  track.id = vehicle.id;
  track.start = vehicle.start;
  track.state_O = vehicle.StateAt(at, filter);
  track.state_O.covariance.topLeftCorner<2, 2>() += vehicle.lasting;
  track.lasting_variance_m2 = vehicle.lasting_variance_m2;
  track.extent = vehicle.extent;
  track.object_class = vehicle.object_class;
  track.existence = vehicle.existence;
  track.is_confirmed = true;
  track.visibility = vehicle.visibility;
  track.support = vehicle.support;
  line.local_id = vehicle.is_supported ? vehicle.local_id : 0;
  line.last_v2v = vehicle.last_v2v;
  line.sender = vehicle.sender;
  line.events = vehicle.events;
  line.bridge_budget_s = std::max(0.0, vehicle.BudgetLeft_s(at, bridge));
  return line;
}

}  // namespace v2vouch
