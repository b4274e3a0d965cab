// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/common/base/sha256.h"
#include "daemon/local/mount_monitor/mount_monitor.h"
#include "daemon/pipeline/perception.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/engine/input_watch.h"
#include "daemon/rim/engine/notice_board.h"
#include "daemon/rim/engine/refusal_table.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// Messages to publish, in order. Their buffers are reused.
class Outbox {
 public:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  void Clear() { count_ = 0; }
  /// The next message's bytes, to be filled.
  std::vector<std::uint8_t>& Add(std::string_view channel) {
    if (count_ == messages_.size()) messages_.emplace_back();
    Message& message = messages_[count_++];
    message.channel.assign(channel);
    return message.bytes;
  }
  [[nodiscard]] std::span<const Message> messages() const { return {messages_.data(), count_}; }

 private:
  std::vector<Message> messages_;
  std::size_t count_ = 0;
};

/// What only a live shell can know; all zero or unknown in replay, so that its status is a function
/// of the log.
struct ShellFigures {
  std::int64_t queue_drops_own = 0;
  std::int64_t queue_drops_bsm = 0;
  std::int64_t images_replaced = 0;  ///< Told among the refusals.
  std::int64_t kernel_drops = -1;
  std::int64_t receive_buffer_bytes = -1;
  std::vector<wire::StageLatency> latencies;
  std::vector<Notice> notices;
  std::vector<wire::DroppedDatagrams> dropped;
};

/// Bytes in, bytes out: decode, perception, encode, with every refusal counted. The daemon and the
/// replay program both are a shell round this; it reads no clock and starts no thread, so the same
/// messages in the same order give the same bytes.
class Engine {
 public:
  explicit Engine(const DaemonConfig& config);

  /// V2VOUCH_CONFIG and CALIBRATION, once at start. Each call below adds to the outbox.
  void Start(Outbox& outbox);

  /// One received message. TRACKS_* after an own-sensor frame, MISBEHAVIOR, and V2VOUCH_STATUS when
  /// a second of time of arrival has passed.
  void OnMessage(std::string_view channel, std::span<const std::uint8_t> bytes, Timestamp received,
                 Outbox& outbox);
  /// What our detector saw in a picture of channel `image_channel`: published and used.
  void OnDetections(std::string_view image_channel, const CameraDetections& detections,
                    Timestamp received, Outbox& outbox);
  /// A message refused on its way here, e.g. a picture that gave no detections.
  void OnRefused(std::string_view channel, const Refusal& refusal, Timestamp received);

  /// Copies of the lists predicted by `silence` past the newest frame, marked stale; in no digest.
  /// Nothing before the first frame.
  void PublishStale(Duration silence, Outbox& outbox);
  /// Where no message comes: it is `at` now, on the clock of `received`.
  void AdvanceTo(Timestamp at) { watch_.AdvanceTo(at); }
  void PublishStatus(Outbox& outbox);

  /// What of the trust in senders outlives a restart, and back before the first message.
  [[nodiscard]] std::vector<TrustMemory> TrustToKeep() const { return perception_.TrustToKeep(); }
  void RestoreTrust(std::vector<TrustMemory> memories) {
    perception_.RestoreTrust(std::move(memories));
  }

  void SetShellFigures(const ShellFigures& figures) { figures_ = figures; }

  [[nodiscard]] std::span<const wire::InputChannel> channels() const { return decoder_.channels(); }
  [[nodiscard]] const wire::InputDecoder& decoder() const { return decoder_; }
  [[nodiscard]] const ReasonCounts& refusals() const { return refusals_; }
  /// The same by channel and field.
  [[nodiscard]] const std::vector<RefusalTable::Row>& refusal_details() const {
    return refusal_table_.rows();
  }
  [[nodiscard]] std::int64_t accepted() const { return watch_.accepted(); }
  [[nodiscard]] std::string digest_local() const { return digest_local_.Hex(); }
  [[nodiscard]] std::string digest_priority() const { return digest_priority_.Hex(); }
  /// What each radar's own returns say of its mount, in the configured order.
  [[nodiscard]] const std::vector<MountVerdict>& mounts() const { return monitor_.verdicts(); }
  /// What began or ended since the last call, as of the last status.
  std::vector<NoticeBoard::Change> TakeNoticeChanges() { return notices_.TakeChanges(); }
  /// LOCAL lists that stayed in because a predicted copy of a later time had gone out.
  [[nodiscard]] std::int64_t withheld() const { return withheld_; }
  /// Whether the last OnMessage or OnDetections gave new lists.
  [[nodiscard]] bool has_lists() const { return has_lists_; }

 private:
  void Take(std::size_t channel, const Input& input, Outbox& outbox);
  void Monitor(const Input& input);
  void PublishLists(Outbox& outbox);
  void Send(const std::string& channel, Timestamp stamp, Timestamp& newest, Outbox& outbox);
  void Refuse(std::string_view channel, const Refusal& refusal, std::uint64_t count = 1,
              std::string_view text = {});
  void Refuse(std::size_t channel, const Refusal& refusal, std::uint64_t count = 1,
              std::string_view text = {});
  [[nodiscard]] std::size_t ChannelOf(const Diagnostic& diagnostic, std::size_t current) const;

  DaemonConfig config_;
  wire::InputDecoder decoder_;
  Perception perception_;
  MountMonitor monitor_;
  InputWatch watch_;
  NoticeBoard notices_;
  Outputs outputs_;
  ReasonCounts refusals_{};
  RefusalTable refusal_table_;
  RefusalTally dropped_;  // Of the message at hand.
  Sha256 digest_local_;
  Sha256 digest_priority_;
  ShellFigures figures_;
  wire::Status status_;
  std::optional<Duration> last_status_;  // In time of arrival.
  struct {
    Timestamp local{};
    Timestamp priority{};
  } published_;  // Newest time that went out, stale copies included.
  std::vector<std::uint8_t> list_bytes_;
  std::int64_t withheld_ = 0;
  bool has_lists_ = false;
};

}  // namespace v2vouch
