// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/common/base/time.h"

namespace v2vouch {

/// A thread that takes messages off an LCM bus into a bounded buffer (16 MB; what does not fit is
/// dropped and counted: the next message says more than the one before).
class LiveSource {
 public:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
    Timestamp received{};
  };

  LiveSource(std::string url, std::vector<std::string> channels);
  ~LiveSource();
  LiveSource(const LiveSource&) = delete;
  LiveSource& operator=(const LiveSource&) = delete;

  /// Takes out what came since the last call.
  void Drain(std::vector<Message>& messages);
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  void Run();

  std::string url_;
  std::vector<std::string> channels_;
  std::mutex mutex_;
  std::vector<Message> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::atomic<bool> is_open_ = false;
  std::atomic<bool> must_stop_ = false;
  std::atomic<std::int64_t> dropped_ = 0;
  std::thread thread_;
};

}  // namespace v2vouch
