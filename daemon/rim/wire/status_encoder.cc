// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/status_encoder.h"

#include <algorithm>

#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/output_fields.h"
#include "v2vouch/daemon_status_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr std::size_t kMaxSenders = 256;

void PutBias(const std::optional<BiasEstimate>& bias, double& east_m, double& north_m,
             double (&covariance_m2)[4]) {
  east_m = bias ? bias->mean_en.x() : kNaN;
  north_m = bias ? bias->mean_en.y() : kNaN;
  for (int i = 0; i < 4; ++i) covariance_m2[i] = bias ? bias->covariance(i / 2, i % 2) : kNaN;
}

gps_bias_t ToWire(const BiasReport& report) {
  gps_bias_t to{};
  to.utime = MicrosOrNever(report.solved_at);
  PutBias(report.common, to.common_east_m, to.common_north_m, to.common_covariance_m2);
  const std::size_t count = std::min(report.senders.size(), kMaxSenders);
  for (std::size_t i = 0; i < count; ++i) {
    const BiasReport::Sender& from = report.senders[i];
    sender_bias_t sender{};
    PutSender(from.sender, sender.v2v_id);
    sender.verdict = static_cast<std::int8_t>(from.verdict);
    const bool has_bias = from.verdict != BiasVerdict::kTooFew;
    PutBias(has_bias ? std::optional(from.bias) : std::nullopt, sender.east_m, sender.north_m,
            sender.covariance_m2);
    if (has_bias) ++(from.verdict == BiasVerdict::kUsed ? to.num_used : to.num_quarantined);
    to.senders.push_back(sender);
  }
  SetCount(to.num_senders, to.senders);
  return to;
}

void PutInputs(const Status& status, daemon_status_t& to) {
  for (const InputStatus& from : status.inputs) {
    input_status_t input{};
    input.channel = Name(from.channel);
    input.received = from.received;
    input.accepted = from.accepted;
    input.gaps = from.gaps;
    input.rate_hz = from.rate_hz;
    input.age_s = from.age_s;
    input.is_silent = from.is_silent ? 1 : 0;
    to.inputs.push_back(input);
  }
  SetCount(to.num_inputs, to.inputs);
}

void PutDropped(const Status& status, daemon_status_t& to) {
  for (const DroppedDatagrams& from : status.dropped) {
    const auto same = std::ranges::find(to.refusals, from.reason, &count_t::name);
    if (same != to.refusals.end()) {
      same->count += static_cast<std::int64_t>(from.count);
    } else {
      count_t count{};
      count.name = Name(from.reason);
      count.count = static_cast<std::int64_t>(from.count);
      to.refusals.push_back(count);
    }
    refusal_t detail{};
    detail.channel = Name(from.bus);
    detail.reason = Name(from.reason);
    detail.field = Name(from.field);
    detail.count = static_cast<std::int64_t>(from.count);
    to.refusal_details.push_back(detail);
  }
}

void PutRefusals(const Status& status, daemon_status_t& to) {
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    if (status.refusals[i] == 0) continue;
    count_t count{};
    count.name = Name(ReasonName(static_cast<Reason>(i)));
    count.count = static_cast<std::int64_t>(status.refusals[i]);
    to.refusals.push_back(count);
  }
  for (const RefusalDetail& from : status.refusal_details) {
    refusal_t detail{};
    detail.channel = Name(from.channel);
    detail.reason = Name(ReasonName(from.refusal.reason));
    detail.field = Name(from.FieldText());
    detail.count = static_cast<std::int64_t>(from.count);
    to.refusal_details.push_back(detail);
  }
  PutDropped(status, to);
  SetCount(to.num_refusals, to.refusals);
  SetCount(to.num_refusal_details, to.refusal_details);
}

void PutLatencies(const Status& status, daemon_status_t& to) {
  for (const StageLatency& from : status.latencies) {
    stage_latency_t latency{};
    latency.stage = Name(from.stage);
    latency.p50_us = from.p50_us;
    latency.p99_us = from.p99_us;
    latency.max_us = from.max_us;
    to.latencies.push_back(latency);
  }
  SetCount(to.num_latencies, to.latencies);
}

void PutMounts(const Status& status, daemon_status_t& to) {
  for (const MountStatus& from : status.mounts) {
    mount_status_t mount{};
    mount.sensor = Name(from.sensor);
    mount.utime = ToMicros(from.stamp);
    mount.yaw_correction_rad = from.yaw_correction_rad;
    mount.yaw_sigma_rad = from.yaw_sigma_rad;
    mount.windows = from.windows;
    mount.suspicious_run = from.suspicious_run;
    mount.has_moved = from.has_moved ? 1 : 0;
    mount.driven_s = from.driven_s;
    to.mounts.push_back(mount);
  }
  SetCount(to.num_mounts, to.mounts);
}

void PutNotices(const Status& status, daemon_status_t& to) {
  for (const NoticeStatus& from : status.notices) {
    notice_t notice{};
    notice.name = Name(from.name);
    notice.channel = Name(from.channel);
    notice.value = from.value;
    notice.since_utime = ToMicros(from.since);
    notice.advice = Name(from.advice);
    to.notices.push_back(notice);
  }
  SetCount(to.num_notices, to.notices);
}

}  // namespace

void EncodeStatus(const Status& status, std::vector<std::uint8_t>& bytes) {
  daemon_status_t to{};
  to.utime = ToMicros(status.stamp);
  to.seq = status.seq;
  to.version = Name(status.version);
  to.calibration = Name(status.calibration);
  PutInputs(status, to);
  PutRefusals(status, to);
  to.queue_drops_own = status.queue_drops_own;
  to.queue_drops_bsm = status.queue_drops_bsm;
  to.kernel_drops = status.kernel_drops;
  to.receive_buffer_bytes = status.receive_buffer_bytes;
  PutLatencies(status, to);
  to.local_tracks = status.local_tracks;
  to.priority_tracks = status.priority_tracks;
  to.v2v_senders = status.v2v_senders;
  to.ego_gnss_suspect = status.ego_gnss_suspect ? 1 : 0;
  to.gps_bias = ToWire(status.gps_bias);
  PutMounts(status, to);
  PutNotices(status, to);
  to.digest_inputs = status.digest_inputs;
  to.digest_local = Name(status.digest_local);
  to.digest_priority = Name(status.digest_priority);
  Encode(to, bytes);
}

}  // namespace v2vouch::wire
