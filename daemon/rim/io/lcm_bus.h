// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "daemon/common/base/time.h"

typedef struct _lcm_t lcm_t;

namespace v2vouch {

/// One LCM instance. Receives bytes only: what they mean is judged elsewhere. Publishing is allowed
/// from one thread while another handles.
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

  /// Takes exactly this channel (LCM reads names as regular expressions). The handler must not
  /// throw and runs in Handle(). @return false when LCM refuses.
  bool Subscribe(const std::string& channel, Handler handler);

  /// Waits up to `timeout_ms` for messages and handles one. @return false when the bus is broken.
  bool Handle(int timeout_ms);

  bool Publish(const std::string& channel, std::span<const std::uint8_t> bytes);

  struct Subscription;  // Known to the callback only.

 private:
  explicit LcmBus(lcm_t* lcm);
  lcm_t* lcm_;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
};

}  // namespace v2vouch
