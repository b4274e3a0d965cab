// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/input_decoder.h"

#include <utility>

#include "daemon/rim/wire/bsm_conversion.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/field_judge.h"
#include "daemon/rim/wire/sensor_conversion.h"
#include "v2vouch/camera_image_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr double kEgoPeriod_s = 0.05;  // The contract's slowest: 20 Hz.
constexpr double kGnssPeriod_s = 1.0;  // The contract's slowest: 1 Hz.
constexpr int kMaxImageSide_px = 16384;

template <class T>
Result<InputDecoder::Decoded> AsInput(Result<T> result) {
  if (!result) return result.refusal();
  return InputDecoder::Decoded(Input(std::move(*result)));
}

std::optional<ImageEncoding> EncodingOf(const std::string& name) {
  if (name == "jpeg") return ImageEncoding::kJpeg;
  if (name == "mono8") return ImageEncoding::kMono8;
  if (name == "bgr8") return ImageEncoding::kBgr8;
  return std::nullopt;
}

Result<CameraImage> ImageFromWire(camera_image_t&& message, const CameraConfig& camera, int index,
                                  Timestamp received) {
  if (!message.sensor.empty() && message.sensor != camera.name) {
    return Refusal{Reason::kSensorMismatch, "sensor"};
  }
  if (const auto fault = TimeFault(message.utime, received); !fault.empty()) {
    return Refusal{Reason::kOutOfRange, fault};
  }
  const auto encoding = EncodingOf(message.encoding);
  if (!encoding) return Refusal{Reason::kBadImage, "encoding"};
  if (message.data.empty()) return Refusal{Reason::kBadImage, "data"};
  const auto is_side = [](int side_px) { return side_px >= 0 && side_px <= kMaxImageSide_px; };
  if (!is_side(message.width_px)) return Refusal{Reason::kBadImage, "width_px"};
  if (!is_side(message.height_px)) return Refusal{Reason::kBadImage, "height_px"};
  // Pixels of another resolution than the intrinsics are for would mean other angles. A driver that
  // does not know its own says 0.
  const int width_px = message.width_px == 0 ? camera.image_width_px : message.width_px;
  const int height_px = message.height_px == 0 ? camera.image_height_px : message.height_px;
  if (width_px != camera.image_width_px) return Refusal{Reason::kOutOfRange, "width_px"};
  if (height_px != camera.image_height_px) return Refusal{Reason::kOutOfRange, "height_px"};
  const std::size_t pixels =
      static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  const std::size_t bytes_per_pixel = *encoding == ImageEncoding::kBgr8 ? 3 : 1;
  if (*encoding != ImageEncoding::kJpeg && message.data.size() != pixels * bytes_per_pixel) {
    return Refusal{Reason::kBadImage, "data"};
  }
  CameraImage image;
  image.stamp = FromMicros(message.utime) + FromSeconds(camera.clock_offset_s);
  image.received = received;
  image.seq = SafeSeq(message.seq);
  image.camera = index;
  image.width_px = width_px;
  image.height_px = height_px;
  image.encoding = *encoding;
  image.bytes = std::move(message.data);
  return image;
}

}  // namespace

std::vector<InputChannel> InputChannels(const VehicleConfig& vehicle, const ChannelNames& names) {
  std::vector<InputChannel> channels;
  channels.push_back({names.ego_motion, InputKind::kEgoMotion, 0, kEgoPeriod_s});
  for (std::size_t i = 0; i < vehicle.radars.size(); ++i) {
    const RadarConfig& radar = vehicle.radars[i];
    channels.push_back(
        {names.radar_prefix + radar.name, InputKind::kRadar, static_cast<int>(i), radar.period_s});
  }
  for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
    const CameraConfig& camera = vehicle.cameras[i];
    std::string name = names.camera_prefix + camera.name;
    if (camera.source == CameraSource::kImage) name += names.image_suffix;
    if (camera.source == CameraSource::kDetected) name = DetectedChannel(names, camera);
    const auto kind =
        camera.source == CameraSource::kImage ? InputKind::kCameraImage : InputKind::kCameraBoxes;
    channels.push_back({name, kind, static_cast<int>(i), camera.period_s});
  }
  for (std::size_t i = 0; i < vehicle.objects.size(); ++i) {
    const ObjectSensorConfig& source = vehicle.objects[i];
    channels.push_back({names.objects_prefix + source.name, InputKind::kObjects,
                        static_cast<int>(i), source.period_s});
  }
  channels.push_back({names.ego_gnss, InputKind::kGnss, 0, kGnssPeriod_s});
  channels.push_back({names.bsm, InputKind::kBsm, 0, 0.0});
  channels.push_back({names.own_bsm, InputKind::kOwnBsm, 0, 0.0});
  return channels;
}

std::string DetectedChannel(const ChannelNames& names, const CameraConfig& camera) {
  return names.camera_prefix + camera.name + names.detected_suffix;
}

InputDecoder::InputDecoder(const VehicleConfig& vehicle, const ChannelNames& names)
    : vehicle_(vehicle), channels_(InputChannels(vehicle, names)) {}

std::optional<std::size_t> InputDecoder::Find(std::string_view channel) const {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].name == channel) return i;
  }
  return std::nullopt;
}

Result<InputDecoder::Decoded> InputDecoder::Decode(std::size_t channel,
                                                   std::span<const std::uint8_t> bytes,
                                                   Timestamp received,
                                                   RefusalTally& dropped) const {
  const InputChannel& from = channels_[channel];
  const auto sensor = static_cast<std::size_t>(from.sensor);
  switch (from.kind) {
    case InputKind::kRadar: {
      const auto message = wire::Decode<radar_scan_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, vehicle_.radars[sensor], from.sensor, received, dropped));
    }
    case InputKind::kCameraBoxes: {
      const auto message = wire::Decode<camera_detections_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, vehicle_.cameras[sensor], from.sensor, received, dropped));
    }
    case InputKind::kCameraImage: {
      auto message = wire::Decode<camera_image_t>(bytes);
      if (!message) return message.refusal();
      auto image =
          ImageFromWire(std::move(*message), vehicle_.cameras[sensor], from.sensor, received);
      if (!image) return image.refusal();
      return Decoded(std::move(*image));
    }
    case InputKind::kObjects: {
      const auto message = wire::Decode<object_list_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, vehicle_.objects[sensor], from.sensor, received, dropped));
    }
    case InputKind::kEgoMotion: {
      const auto message = wire::Decode<ego_motion_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, vehicle_, received, dropped));
    }
    case InputKind::kGnss: {
      const auto message = wire::Decode<gnss_fix_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, vehicle_, received, dropped));
    }
    case InputKind::kBsm: {
      const auto message = wire::Decode<bsm_t>(bytes);
      if (!message) return message.refusal();
      return AsInput(FromWire(*message, received, dropped));
    }
    case InputKind::kOwnBsm: {
      const auto message = wire::Decode<bsm_t>(bytes);
      if (!message) return message.refusal();
      auto bsm = FromWire(*message, received, dropped);
      if (!bsm) return bsm.refusal();
      return Decoded(OwnBsm{*std::move(bsm)});
    }
  }
  return Reason::kUnknownChannel;
}

}  // namespace v2vouch::wire
