// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/rim/lcm_packets/packet_fault.h"

typedef struct _lcm_t lcm_t;  // NOLINT(bugprone-reserved-identifier): liblcm's own name.

namespace v2vouch {

class UdpmReceiver;

/// One LCM bus. Receives bytes only: what they mean is judged elsewhere. Publishing is allowed from
/// one thread while another handles.
///
/// A udpm:// URL is received by our own path (UdpmReceiver), which no datagram can harm, or with
/// `receiver=liblcm` in the URL by liblcm. Other URLs (memq://, file://, tcpq://, mpudpm://) are
/// liblcm's, and liblcm publishes to all.
class LcmBus {
 public:
  /// `size` may be more than any message can have (a bare header makes liblcm 1.3.1 report nearly
  /// 2^32 bytes): then `bytes` is empty.
  using Handler = std::function<void(std::span<const std::uint8_t> bytes, std::size_t size,
                                     Timestamp received)>;

  /// @param url "" = the environment's LCM_DEFAULT_URL, else LCM's own default.
  /// @return nullptr where the URL is wrong (LcmUrlProblems() tells; liblcm is not asked, which
  /// would abort at some), or there is no way out yet, e.g. no multicast route while the machine
  /// boots.
  static std::unique_ptr<LcmBus> Open(const std::string& url);
  ~LcmBus();
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  /// Takes exactly this channel (liblcm reads names as regular expressions). The handler must not
  /// throw and runs in Handle(). @return false when it cannot be, e.g. for want of a route.
  bool Subscribe(const std::string& channel, Handler handler);

  /// Hears every channel, for programs that record or look. @return false when it cannot be.
  using AnyHandler = std::function<void(std::string_view channel,
                                        std::span<const std::uint8_t> bytes, Timestamp received)>;
  bool SubscribeAll(AnyHandler handler);

  /// Waits up to `timeout_ms` for messages and handles one, or the few that wait. @return false
  /// when the bus is broken.
  bool Handle(int timeout_ms);

  bool Publish(const std::string& channel, std::span<const std::uint8_t> bytes);

  /// What our own path refused below the message so far; from any thread. Nothing with liblcm,
  /// which does not say.
  [[nodiscard]] lcm_packets::PacketCounts refused() const;
  /// How often the multicast group had to be joined again.
  [[nodiscard]] std::int64_t rejoins() const;

  struct Subscription;  // Known to the callback only.

 private:
  LcmBus(lcm_t* lcm, std::string url);
  lcm_t* lcm_;
  std::string url_;
  std::unique_ptr<UdpmReceiver> receiver_;  // From the first subscription on.
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::unique_ptr<AnyHandler> any_;
};

}  // namespace v2vouch
