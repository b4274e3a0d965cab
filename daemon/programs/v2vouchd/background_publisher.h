// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace v2vouch {

/// Publishes large diagnostic messages, such as the list of a thousand senders (1 MB in
/// some hundred datagrams), from a thread and a socket of its own: no list waits for them. Where it
/// cannot keep up the newest message wins.
class BackgroundPublisher {
 public:
  explicit BackgroundPublisher(std::string url);
  ~BackgroundPublisher();
  BackgroundPublisher(const BackgroundPublisher&) = delete;
  BackgroundPublisher& operator=(const BackgroundPublisher&) = delete;

  void Offer(const std::string& channel, std::span<const std::uint8_t> bytes);

 private:
  void Run();

  std::string url_;
  std::mutex mutex_;
  std::condition_variable has_one_;
  bool must_stop_ = false;
  bool is_waiting_ = false;  // A message is.
  std::string channel_;
  std::vector<std::uint8_t> bytes_;
  std::thread thread_;
};

}  // namespace v2vouch
