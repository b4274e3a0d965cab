// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/engine.h"

#include <memory>

#include "daemon/rim/engine/calibration_in_force.h"
#include "daemon/rim/wire/output_encoder.h"
#include "daemon/rim/wire/status_encoder.h"
#include "daemon/v2v/gps_bias/gps_bias.h"

namespace v2vouch {
namespace {

constexpr Duration kStatusPeriod = std::chrono::seconds(1);

std::unique_ptr<BiasEstimator> MakeBiasEstimator(const GpsBiasConfig& config) {
  if (!config.enabled) return std::make_unique<NullBiasEstimator>();
  return std::make_unique<GpsBias>(config);
}

}  // namespace

Engine::Engine(const DaemonConfig& config)
    : config_(config),
      decoder_(config.perception.vehicle, config.lcm.channels),
      perception_(config.perception, MakeBiasEstimator(config.gps_bias)),
      monitor_(config.mount_monitor, config.perception.vehicle),
      watch_(decoder_.channels()),
      notices_(decoder_.channels()) {
  status_.version = V2VOUCH_VERSION;
  status_.calibration = CalibrationTitle(config);
}

void Engine::Start(Outbox& outbox) {
  const wire::ChannelNames& names = config_.lcm.channels;
  wire::EncodeText({}, "configuration", PrintDaemonConfig(config_), outbox.Add(names.config));
  wire::EncodeCalibration(CalibrationInForce(config_), outbox.Add(names.calibration));
}

void Engine::OnMessage(std::string_view channel, std::span<const std::uint8_t> bytes,
                       Timestamp received, Outbox& outbox) {
  has_lists_ = false;
  const auto index = decoder_.Find(channel);
  if (!index) return Refuse(channel, Reason::kUnknownChannel);
  watch_.Received(*index, received);
  dropped_.Clear();
  const auto decoded = decoder_.Decode(*index, bytes, received, dropped_);
  for (const RefusalTally::Entry& entry : dropped_.entries()) {
    Refuse(*index, entry.refusal, entry.count, entry.text);
  }
  if (!decoded) return Refuse(*index, decoded.refusal());
  if (const auto* input = std::get_if<Input>(&*decoded)) {
    Take(*index, *input, outbox);
  } else if (const auto* own = std::get_if<wire::OwnBsm>(&*decoded)) {
    perception_.NoteOwnId(own->bsm.sender, own->bsm.stamp);
    watch_.Accepted(*index, own->bsm.stamp, own->bsm.seq);
  } else {
    Refuse(*index, Reason::kNoDetector);
  }
}

void Engine::OnDetections(std::string_view image_channel, const CameraDetections& detections,
                          Timestamp received, Outbox& outbox) {
  has_lists_ = false;
  const auto index = decoder_.Find(image_channel);
  if (!index) return Refuse(image_channel, Reason::kUnknownChannel);
  watch_.Received(*index, received);
  const CameraConfig& camera =
      config_.perception.vehicle.cameras[static_cast<std::size_t>(detections.camera)];
  wire::EncodeDetections(detections, camera,
                         outbox.Add(wire::DetectedChannel(config_.lcm.channels, camera)));
  Take(*index, detections, outbox);
}

void Engine::OnRefused(std::string_view channel, const Refusal& refusal, Timestamp received) {
  has_lists_ = false;
  const auto index = decoder_.Find(channel);
  if (!index) return Refuse(channel, refusal);
  watch_.Received(*index, received);
  Refuse(*index, refusal);
}

void Engine::Refuse(std::string_view channel, const Refusal& refusal, std::uint64_t count,
                    std::string_view text) {
  refusals_[static_cast<std::size_t>(refusal.reason)] += count;
  refusal_table_.Add(channel, refusal, count, text);
}

void Engine::Refuse(std::size_t channel, const Refusal& refusal, std::uint64_t count,
                    std::string_view text) {
  const wire::InputChannel& from = decoder_.channels()[channel];
  Refuse(from.name, WithField(refusal, from.kind), count, text);
}

// A message may bring out the refusal of an earlier one, which it made the core step again.
std::size_t Engine::ChannelOf(const Diagnostic& diagnostic, std::size_t current) const {
  if (diagnostic.source == InputSource::kThis) return current;
  const auto is_kind = [&](wire::InputKind kind) {
    switch (diagnostic.source) {
      case InputSource::kEgoMotion:
        return kind == wire::InputKind::kEgoMotion;
      case InputSource::kGnss:
        return kind == wire::InputKind::kGnss;
      case InputSource::kRadar:
        return kind == wire::InputKind::kRadar;
      case InputSource::kCamera:
        return kind == wire::InputKind::kCameraBoxes || kind == wire::InputKind::kCameraImage;
      case InputSource::kObjects:
        return kind == wire::InputKind::kObjects;
      case InputSource::kBsm:
        return kind == wire::InputKind::kBsm;
      case InputSource::kThis:
        break;
    }
    return false;
  };
  const auto channels = decoder_.channels();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (is_kind(channels[i].kind) && channels[i].sensor == diagnostic.sensor) return i;
  }
  return current;
}

void Engine::Take(std::size_t channel, const Input& input, Outbox& outbox) {
  const auto refusal = perception_.Step(input, outputs_);
  for (const Diagnostic& diagnostic : outputs_.diagnostics) {
    Refuse(ChannelOf(diagnostic, channel), {diagnostic.reason, diagnostic.field});
    if (diagnostic.reason == Reason::kClockRestart) {
      watch_.Restart();
      monitor_.Restart();
      published_ = {};
    }
  }
  if (!refusal) {
    const MessageHeader& header = HeaderOf(input);
    watch_.Accepted(channel, header.stamp, header.seq);
    Monitor(input);
  }

  if (outputs_.has_lists) PublishLists(outbox);
  if (outputs_.has_v2v_list) {
    wire::EncodeList(outputs_.v2v, config_.perception.vehicle,
                     outbox.Add(config_.lcm.channels.tracks_v2v));
  }
  for (const MisbehaviorReport& report : outputs_.reports) {
    wire::EncodeReport(report, outbox.Add(config_.lcm.channels.misbehavior));
  }
  for (const BsmVerdict& verdict : outputs_.bsm_verdicts) {
    wire::EncodeVerdict(verdict, outbox.Add(config_.lcm.channels.bsm_verdict));
  }
  if (!last_status_ || watch_.elapsed() - *last_status_ >= kStatusPeriod) PublishStatus(outbox);
}

void Engine::Monitor(const Input& input) {
  if (const auto* motion = std::get_if<EgoMotion>(&input)) monitor_.OnEgoMotion(*motion);
  if (const auto* scan = std::get_if<RadarScan>(&input)) monitor_.OnRadarScan(*scan);
}

void Engine::PublishLists(Outbox& outbox) {
  const wire::ChannelNames& names = config_.lcm.channels;
  has_lists_ = true;
  // The digests are of what the core made. A list older than a predicted copy that went out before
  // it stays here: published time does not go back.
  list_bytes_.clear();
  wire::EncodeList(outputs_.local, config_.perception.vehicle, list_bytes_);
  digest_local_.Add(list_bytes_);
  Send(names.tracks_local, outputs_.local.stamp, published_.local, outbox);
  wire::EncodeList(outputs_.priority, config_.perception.vehicle, list_bytes_);
  digest_priority_.Add(list_bytes_);
  Send(names.tracks_priority, outputs_.priority.stamp, published_.priority, outbox);
  status_.local_tracks = static_cast<int>(outputs_.local.tracks.size());
  status_.priority_tracks = static_cast<int>(outputs_.priority.tracks.size());
}

void Engine::Send(const std::string& channel, Timestamp stamp, Timestamp& newest, Outbox& outbox) {
  if (stamp < newest) {
    if (channel == config_.lcm.channels.tracks_local) ++withheld_;
    return;
  }
  newest = stamp;
  outbox.Add(channel).assign(list_bytes_.begin(), list_bytes_.end());
}

void Engine::PublishStale(Duration silence, Outbox& outbox) {
  const Timestamp newest = perception_.newest_frame();
  if (newest == Timestamp{}) return;
  // A frame that is on its way carries an older stamp than its arrival. The copies keep that far
  // behind, so that the list it will give is not older than they were.
  const Duration ahead =
      std::max(Duration::zero(), silence - FromSeconds(config_.perception.timeline.stale_after_s));
  Outputs predicted;
  perception_.PredictedLists(newest + ahead, predicted);
  if (!predicted.has_lists) return;
  const wire::ChannelNames& names = config_.lcm.channels;
  wire::EncodeList(predicted.local, config_.perception.vehicle, list_bytes_);
  Send(names.tracks_local, predicted.local.stamp, published_.local, outbox);
  wire::EncodeList(predicted.priority, config_.perception.vehicle, list_bytes_);
  Send(names.tracks_priority, predicted.priority.stamp, published_.priority, outbox);
}

void Engine::PublishStatus(Outbox& outbox) {
  last_status_ = watch_.elapsed();
  status_.stamp = perception_.agreed_time().value_or(Timestamp{});
  ++status_.seq;
  watch_.Report(status_.inputs);
  status_.refusals = refusals_;
  status_.refusals[static_cast<std::size_t>(Reason::kImageReplaced)] +=
      static_cast<std::uint64_t>(figures_.images_replaced);
  status_.refusal_details = refusal_table_.rows();
  status_.dropped = figures_.dropped;
  status_.queue_drops_own = figures_.queue_drops_own;
  status_.queue_drops_bsm = figures_.queue_drops_bsm;
  status_.kernel_drops = figures_.kernel_drops;
  status_.receive_buffer_bytes = figures_.receive_buffer_bytes;
  status_.latencies = figures_.latencies;
  status_.v2v_senders = perception_.sender_count();
  status_.ego_gnss_suspect = perception_.ego_gnss_suspect();
  status_.gps_bias = perception_.bias_report();
  status_.mounts.clear();
  const std::vector<RadarConfig>& radars = config_.perception.vehicle.radars;
  for (std::size_t i = 0; i < radars.size(); ++i) {
    const MountVerdict& mount = monitor_.verdicts()[i];
    status_.mounts.push_back({.sensor = "radar_" + LowerCaseName(radars[i].name),
                              .stamp = mount.stamp,
                              .yaw_correction_rad = mount.yaw_correction_rad,
                              .yaw_sigma_rad = mount.yaw_sigma_rad,
                              .windows = mount.windows,
                              .suspicious_run = mount.suspicious_run,
                              .has_moved = mount.has_moved,
                              .driven_s = mount.driven_s});
  }
  std::vector<Notice> notices;
  perception_.CollectNotices(notices);
  watch_.CollectNotices(notices);
  notices.insert(notices.end(), figures_.notices.begin(), figures_.notices.end());
  notices_.Update(notices, status_.stamp);
  status_.notices = notices_.in_force();
  status_.digest_inputs = watch_.accepted();
  status_.digest_local = digest_local_.Hex();
  status_.digest_priority = digest_priority_.Hex();
  wire::EncodeStatus(status_, outbox.Add(config_.lcm.channels.status));
}

}  // namespace v2vouch
