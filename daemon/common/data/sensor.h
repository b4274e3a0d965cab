// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// The kinds of own sensors, by what they deliver. Values are those of track_source_t.
enum class SensorKind : std::uint8_t {
  kRadar = 0,    ///< Reflections with Doppler.
  kCamera = 1,   ///< Boxes in a picture: bearings, a class, a guess of the range.
  kObjects = 2,  ///< Boxes on the ground: position, axis, size, perhaps velocity.
};
inline constexpr std::size_t kSensorKinds = 3;
inline constexpr std::array<SensorKind, kSensorKinds> kAllSensorKinds = {
    SensorKind::kRadar, SensorKind::kCamera, SensorKind::kObjects};

/// The configuration may list so many sensors of each kind.
inline constexpr int kMostSensorsOfAKind = 32;

/// One own sensor: its kind and its index in that kind's list of VehicleConfig.
struct SensorKey {
  SensorKind kind = SensorKind::kRadar;
  int index = 0;
  friend auto operator<=>(const SensorKey&, const SensorKey&) = default;
};

/// Its number among all sensors that can be configured, in [0, kSensorSlots).
inline constexpr std::size_t kSensorSlots = kSensorKinds * kMostSensorsOfAKind;
constexpr std::size_t SlotOf(SensorKey sensor) {
  return static_cast<std::size_t>(sensor.kind) * kMostSensorsOfAKind +
         static_cast<std::size_t>(sensor.index);
}

/// Which sensors have measured a track, how often and when last. Fixed size: checkpoints copy every
/// track.
class SensorSupport {
 public:
  /// Of each sensor the last measurement; more sensors than these push out the one longest silent.
  static constexpr std::size_t kMostSources = 16;
  struct Source {
    SensorKey sensor;
    Timestamp last{};
  };

  SensorSupport() = default;
  /// Copies what is in use only.
  SensorSupport(const SensorSupport& other) { *this = other; }
  SensorSupport& operator=(const SensorSupport& other) {
    kinds_ = other.kinds_;
    count_ = other.count_;
    std::copy_n(other.sources_.begin(), count_, sources_.begin());
    return *this;
  }

  void Add(SensorKey sensor, Timestamp stamp) {
    Kind& kind = kinds_[static_cast<std::size_t>(sensor.kind)];
    kind.last = stamp;
    ++kind.hits;
    Source* const end = sources_.data() + count_;
    Source* at = std::find_if(sources_.data(), end,
                              [&](const Source& source) { return source.sensor == sensor; });
    if (at == end && count_ < kMostSources) {
      ++count_;
    } else if (at == end) {
      at = std::min_element(sources_.data(), end,
                            [](const Source& a, const Source& b) { return a.last < b.last; });
    }
    *at = {sensor, stamp};
  }

  /// Measurements by all sensors of a kind, since the track's start.
  [[nodiscard]] int hits(SensorKind kind) const { return Of(kind).hits; }
  [[nodiscard]] int hits() const {
    int sum = 0;
    for (const Kind& kind : kinds_) sum += kind.hits;
    return sum;
  }
  /// The last of them; nullopt: none.
  [[nodiscard]] std::optional<Timestamp> last(SensorKind kind) const { return Of(kind).last; }
  /// The last by any sensor; Timestamp{}: none.
  [[nodiscard]] Timestamp last() const {
    Timestamp newest{};
    for (const Kind& kind : kinds_) newest = std::max(newest, kind.last.value_or(Timestamp{}));
    return newest;
  }
  [[nodiscard]] bool IsHitAt(Timestamp stamp) const {
    return std::ranges::any_of(kinds_, [&](const Kind& kind) { return kind.last == stamp; });
  }
  /// In the order in which they first measured it, up to kMostSources.
  [[nodiscard]] std::span<const Source> sources() const { return {sources_.data(), count_}; }

  /// Whether one frame of a sensor of this kind had them both, as the last that the sensor had of
  /// either: it saw two objects.
  [[nodiscard]] bool SharesFrame(const SensorSupport& other, SensorKind kind) const {
    return std::ranges::any_of(sources(), [&](const Source& a) {
      return a.sensor.kind == kind && std::ranges::any_of(other.sources(), [&](const Source& b) {
               return a.sensor == b.sensor && a.last == b.last;
             });
    });
  }

 private:
  struct Kind {
    std::optional<Timestamp> last{};
    int hits = 0;
  };
  [[nodiscard]] const Kind& Of(SensorKind kind) const {
    return kinds_[static_cast<std::size_t>(kind)];
  }

  std::array<Kind, kSensorKinds> kinds_{};
  std::array<Source, kMostSources> sources_;  // The first count_ are in use.
  std::size_t count_ = 0;
};

/// What a sender says of itself beside its motion, and what follows from its motion by J2735's own
/// definition; a bit each, as in track_t.
enum TrackEvent : std::uint8_t {
  kHardBraking = 1U << 0,
  kEmergencyVehicle = 1U << 1,
  kTurnSignalLeft = 1U << 2,
  kTurnSignalRight = 1U << 3,
  kBrakeLamps = 1U << 4,
};
using TrackEvents = std::uint8_t;

}  // namespace v2vouch
