// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/common/base/time.h"
#include "daemon/common/data/bias.h"

namespace v2vouch::wire {

/// What daemon_status_t says, as plain values.
struct InputStatus {
  std::string channel;
  std::int64_t received = 0;
  std::int64_t accepted = 0;
  std::int64_t gaps = 0;
  double rate_hz = 0.0;
  double age_s = 0.0;  ///< NaN: nothing came yet.
  bool is_silent = false;
};

struct RefusalDetail {
  std::string channel;
  Refusal refusal;
  std::uint64_t count = 0;
  std::string text;  ///< What the field held, where that is a name.

  /// The field as published: "boxes.class_name 'forklift'".
  [[nodiscard]] std::string FieldText() const {
    std::string field(refusal.field);
    return text.empty() ? field : field + " '" + text + "'";
  }
};

/// Refused before there was a message, since start.
struct DroppedDatagrams {
  std::string bus;  ///< In the place of a channel.
  std::string reason;
  std::string field;
  std::uint64_t count = 0;
};

struct MountStatus {
  std::string sensor;
  Timestamp stamp{};  ///< Timestamp{}: no window yet.
  double yaw_correction_rad = 0.0;
  double yaw_sigma_rad = 0.0;
  int windows = 0;
  int suspicious_run = 0;
  bool has_moved = false;
  double driven_s = 0.0;
};

/// A condition in force; see daemon/common/base/notice.h.
struct NoticeStatus {
  std::string name;
  std::string channel;  ///< Empty: the car as a whole.
  double value = 0.0;   ///< NaN: none.
  Timestamp since{};
  std::string advice;
};

struct StageLatency {
  std::string stage;
  double p50_us = 0.0;
  double p99_us = 0.0;
  double max_us = 0.0;
};

struct Status {
  Timestamp stamp{};
  std::int64_t seq = 0;
  std::string version;
  std::string calibration;
  std::vector<InputStatus> inputs;
  ReasonCounts refusals{};
  std::vector<RefusalDetail> refusal_details;
  std::vector<DroppedDatagrams> dropped;  ///< Told among the refusals.
  std::int64_t queue_drops_own = 0;
  std::int64_t queue_drops_bsm = 0;
  std::int64_t kernel_drops = -1;
  std::int64_t receive_buffer_bytes = -1;
  std::vector<StageLatency> latencies;
  int local_tracks = 0;
  int priority_tracks = 0;
  int v2v_senders = 0;
  bool ego_gnss_suspect = false;
  BiasReport gps_bias;
  std::vector<MountStatus> mounts;
  std::vector<NoticeStatus> notices;
  std::int64_t digest_inputs = 0;
  std::string digest_local;
  std::string digest_priority;
};

/// What calibration_t says.
struct CalibrationParameter {
  std::string name;
  double value = 0.0;
  double std = 0.0;
  std::string verdict;
};

struct CalibrationInForce {
  Timestamp stamp{};
  std::string source;
  std::string checksum;
  std::vector<CalibrationParameter> parameters;
};

}  // namespace v2vouch::wire
