// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/common/base/refusal_tally.h"
#include "daemon/common/base/result.h"
#include "daemon/common/data/camera_image.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/rim/wire/channels.h"

namespace v2vouch::wire {

enum class InputKind {
  kRadar,
  kCameraBoxes,
  kCameraImage,
  kObjects,
  kEgoMotion,
  kGnss,
  kBsm,
  kOwnBsm,  ///< What this car itself sends, told by its gateway.
};

/// One channel that this vehicle listens to.
struct InputChannel {
  std::string name;
  InputKind kind = InputKind::kBsm;
  int sensor = 0;         ///< Index of the sensor in its list.
  double period_s = 0.0;  ///< Nominal; 0: messages come when they come.

  /// From the V2V side: BSMs, received or sent.
  [[nodiscard]] bool is_v2v() const {
    return kind == InputKind::kBsm || kind == InputKind::kOwnBsm;
  }
  /// Few cars have it: worth no word while nothing comes.
  [[nodiscard]] bool is_optional() const { return kind == InputKind::kOwnBsm; }
};

/// A BSM that this car has sent: its echoes bear the same sender.
struct OwnBsm {
  Bsm bsm;
};

/// Every input channel of a vehicle: ego motion, radars, cameras (one channel each, as the
/// camera's `source` says), sources of objects, GNSS, BSMs, the own car's BSMs.
std::vector<InputChannel> InputChannels(const VehicleConfig& vehicle, const ChannelNames& names);

/// Where what our detector saw through `camera` is published: CAMERA_<NAME>_DETECTED.
std::string DetectedChannel(const ChannelNames& names, const CameraConfig& camera);

/// From the bytes of a channel to checked data: codec, then content (sensor_conversion,
/// bsm_conversion). Pure.
class InputDecoder {
 public:
  InputDecoder(const VehicleConfig& vehicle, const ChannelNames& names);

  [[nodiscard]] std::span<const InputChannel> channels() const { return channels_; }
  /// Position in channels(); nullopt for a channel that is none of ours.
  [[nodiscard]] std::optional<std::size_t> Find(std::string_view channel) const;

  using Decoded = std::variant<Input, CameraImage, OwnBsm>;
  /// `dropped` counts detections and boxes left out of a message that was taken, and figures that
  /// were left unused (kFieldUnused), by field.
  Result<Decoded> Decode(std::size_t channel, std::span<const std::uint8_t> bytes,
                         Timestamp received, RefusalTally& dropped) const;

 private:
  VehicleConfig vehicle_;
  std::vector<InputChannel> channels_;
};

}  // namespace v2vouch::wire
