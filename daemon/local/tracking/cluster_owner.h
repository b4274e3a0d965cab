// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "daemon/common/base/scratch.h"
#include "daemon/common/data/measurement.h"
#include "daemon/local/tracking/association.h"
#include "daemon/local/tracking/sensor_look.h"
#include "daemon/local/tracking/track_table.h"

namespace v2vouch {

/// Two clusters of one vehicle as one: means weighted by the number of reflections, edges joined.
/// Range rates are compared with what the vehicle's velocity gives at each azimuth: seen from close
/// by it changes along a vehicle by more than the mean of two rates bears.
/// @param v_TA_R velocity of the vehicle relative to the antenna, axes of R [m/s].
RadarMeasurement JoinClusters(const RadarMeasurement& a, const RadarMeasurement& b,
                              const Eigen::Vector2d& v_TA_R);

/// Whether a cluster at `p_O` can be a part of the tracked vehicle: inside its box, or round the
/// reflecting point of a vehicle whose direction is unknown, and moving with it.
bool IsPartOf(TrackTable::ConstRow row, const RadarLook& look, const RadarMeasurement& z,
              const Eigen::Vector2d& p_O);
/// Whether a box that no track was given shows (a part of) a tracked vehicle after all: half hidden
/// vehicles have edges where the hiding one ends.
bool IsPartOf(const LocalTrack& track, const CameraLook& look, const CameraMeasurement& z,
              const Fix& fix);

/// Which vehicle each cluster of one radar scan belongs to, once the scan is associated. A further
/// cluster inside a tracked vehicle's footprint with its Doppler belongs to that vehicle: it joins
/// the measurement and starts nothing. So does a stationary vehicle's face before what was taken
/// for it. Track i as in the table, cluster j as in the scan. Working memory of one scan.
class ClusterOwners {
 public:
  void Find(const RadarLook& look, std::span<const RadarMeasurement> measurements,
            const TrackTable& table, const Association& association);

  /// Whether cluster j was assigned to a track or belongs to a tracked vehicle.
  [[nodiscard]] bool IsOwned(std::size_t j) const { return owner_[j] >= 0; }
  /// What track i was given, with all that belongs to it. To be asked of tracks that were given
  /// something (Association::GivenTo).
  [[nodiscard]] const RadarMeasurement& joined(std::size_t i) const { return joined_[i]; }

 private:
  static constexpr int kNobody = -1;
  static constexpr int kAssigned = 1 << 30;  // Has a track of its own; joins no other.

  void FindByPlace(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                   const TrackTable& table, const Association& association);
  void FindFaces(const RadarLook& look, std::span<const RadarMeasurement> measurements,
                 const TrackTable& table, const Association& association);
  void Join(const RadarLook& look, std::span<const RadarMeasurement> measurements,
            const TrackTable& table, const Association& association);

  Scratch<std::vector<int>> owner_;                // Index of a track, kNobody or kAssigned.
  Scratch<std::vector<RadarMeasurement>> joined_;  // By track.
};

}  // namespace v2vouch
