// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>

#include "daemon/app/message_queue.h"
#include "daemon/base/result.h"
#include "daemon/wire/input_decoder.h"

namespace v2vouch {

/// Finds vehicles and road users in a picture. Called from one thread.
class ObjectDetector {
 public:
  virtual ~ObjectDetector() = default;
  /// Detections carry the picture's own stamp, seq and camera.
  virtual Result<CameraDetections> Detect(const CameraImage& image) = 0;
};

/// Pictures to detections, beside the fusion thread, which never waits for it. Each camera has one
/// slot; a newer picture replaces one that still waits.
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
  std::map<std::string, Arrival> slots_;
  std::int64_t replaced_ = 0;
  bool must_stop_ = false;
  std::thread thread_;
};

}  // namespace v2vouch
