// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/common/data/outputs.h"
#include "daemon/v2v/priority/priority_vehicle.h"

namespace v2vouch {

/// The vehicles of the PRIORITY list, ordered by id. A vehicle that has ended keeps its place,
/// with id 0, until DropEnded(): loops over the list and pointers into it stay good meanwhile.
/// Copyable: part of every checkpoint.
class PriorityList {
 public:
  static constexpr double kOnePlace_m = 2.0;  ///< Centres of two vehicles are never so close.

  /// Vehicles that have ended included.
  [[nodiscard]] std::span<PriorityVehicle> vehicles() { return vehicles_; }
  [[nodiscard]] std::span<const PriorityVehicle> vehicles() const { return vehicles_; }

  /// Null where the sender has none.
  [[nodiscard]] PriorityVehicle* Of(SenderId sender);
  [[nodiscard]] const PriorityVehicle* Of(SenderId sender) const;
  /// Whether a vehicle rests on this LOCAL track.
  [[nodiscard]] bool Holds(std::uint64_t local_id) const;
  /// The vehicle of another sender that the sensors see as this LOCAL track.
  [[nodiscard]] bool HoldsForAnother(std::uint64_t local_id, SenderId sender) const;
  /// The vehicle that the sensors see as this LOCAL track; null: none.
  [[nodiscard]] const PriorityVehicle* SupportedBy(std::uint64_t local_id) const;
  /// Whether another sender's vehicle is at the same position: one that the sensors support, or one
  /// that is bridged.
  [[nodiscard]] bool HasAnotherAt(const Eigen::Vector2d& p_O, SenderId but,
                                  bool is_supported) const;

  /// An id for a vehicle that starts on this LOCAL track.
  [[nodiscard]] std::uint64_t FreeId(std::uint64_t local_id) const;
  void Add(const PriorityVehicle& vehicle);
  void DropEnded();

 private:
  std::vector<PriorityVehicle> vehicles_;
};

/// The vehicle as a line of the list at `at`; position, trust and bias are the caller's to add.
PublishedTrack LineOf(const PriorityVehicle& vehicle, Timestamp at,
                      const PriorityFilterConfig& filter, const BridgeConfig& bridge);

}  // namespace v2vouch
