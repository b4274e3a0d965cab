// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/detect/detect_log.h"

#include <memory>
#include <set>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/output_encoder.h"

namespace v2vouch {
namespace {

constexpr std::int64_t kEventsPerProgress = 64;

Result<CameraDetections> Look(const wire::InputDecoder& decoder, std::size_t channel,
                              const LogEvent& event, ObjectDetector& detector) {
  RefusalTally unused;
  const auto decoded = decoder.Decode(channel, event.bytes, event.received, unused);
  if (!decoded) return decoded.refusal();
  const auto* image = std::get_if<CameraImage>(&*decoded);
  if (image == nullptr) return Reason::kBadImage;
  try {
    return detector.Detect(*image);
  } catch (const std::exception&) {
    return Reason::kBadImage;
  }
}

}  // namespace

bool DetectLog(const std::string& in, const std::string& out, const DaemonConfig& config,
               ObjectDetector& detector, const std::function<bool(double)>& progress,
               DetectLogResult& result, std::string& error) {
  const auto reader = LogReader::Open(in, error);
  if (!reader) return false;
  const auto writer = LogWriter::Create(out, error, std::span(&in, 1));
  if (!writer) return false;

  const VehicleConfig& vehicle = config.perception.vehicle;
  const wire::InputDecoder decoder(vehicle, config.lcm.channels);
  std::set<std::string> unknown;
  std::set<std::string> detected;
  for (const CameraConfig& camera : vehicle.cameras) {
    if (camera.source != CameraSource::kImage) continue;
    detected.insert(wire::DetectedChannel(config.lcm.channels, camera));
  }
  LogEvent event;
  std::vector<std::uint8_t> bytes;
  while (reader->Next(event)) {
    if (++result.events % kEventsPerProgress == 0 && !progress(reader->progress())) {
      error = "stopped";
      return false;
    }
    if (!writer->is_good()) break;
    if (detected.contains(event.channel)) continue;
    writer->Write(event.received, event.channel, event.bytes);
    const auto channel = decoder.Find(event.channel);
    if (!channel && event.channel.ends_with(config.lcm.channels.image_suffix)) {
      unknown.insert(event.channel);
    }
    if (!channel || decoder.channels()[*channel].kind != wire::InputKind::kCameraImage) continue;
    ++result.pictures;
    const auto detections = Look(decoder, *channel, event, detector);
    if (!detections) {
      ++result.refused[static_cast<std::size_t>(detections.reason())];
      continue;
    }
    result.boxes += static_cast<std::int64_t>(detections->boxes.size());
    const auto& camera = vehicle.cameras[static_cast<std::size_t>(detections->camera)];
    wire::EncodeDetections(*detections, camera, bytes);
    writer->Write(event.received, wire::DetectedChannel(config.lcm.channels, camera), bytes);
  }
  result.damaged = reader->damaged();
  result.unknown_pictures.assign(unknown.begin(), unknown.end());
  return writer->Close(error);
}

}  // namespace v2vouch
