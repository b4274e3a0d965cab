// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daemon/detector/object_detector.h"
#include "daemon/programs/v2vouchd/message_queue.h"
#include "daemon/rim/wire/input_decoder.h"

namespace v2vouch {

/// Pictures to detections, beside the fusion thread, which never waits for it and whose core it
/// leaves when both want the same one (lower scheduling priority). Each camera has one slot, in
/// which a newer picture replaces one that still waits; cameras take turns.
class DetectThread {
 public:
  /// @param detector nullptr: every picture is refused with kNoDetector.
  DetectThread(const wire::InputDecoder& decoder, ObjectDetector* detector, MessageQueue& queue);
  ~DetectThread();

  void Offer(Arrival picture);
  /// Pictures that a newer one replaced.
  [[nodiscard]] std::int64_t replaced() const;

 private:
  void Run();
  [[nodiscard]] Arrival::Content Look(const Arrival& picture);

  const wire::InputDecoder& decoder_;
  ObjectDetector* detector_;
  MessageQueue& queue_;
  mutable std::mutex mutex_;
  std::condition_variable has_some_;
  struct Slot {
    std::optional<Arrival> picture;
    std::uint64_t last_look = 0;  // Turn in which this camera was served last.
  };
  // The waiting picture of the camera that was served longest ago.
  std::optional<Arrival> NextPicture();

  std::map<std::string, Slot> slots_;
  std::uint64_t turn_ = 0;
  std::int64_t replaced_ = 0;
  bool must_stop_ = false;
  std::thread thread_;
};

}  // namespace v2vouch
