// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/obu/gateway/gateway_config.h"
#include "daemon/obu/message/own_sender.h"
#include "daemon/rim/io/lcm_bus.h"

namespace v2vouch::obu {

/// What own_bsm of the configuration says beyond single values: the interlock, form, address.
void CheckOwnBsm(const OwnBsmConfig& config, std::vector<std::string>& problems);

/// Sends the own car's BSMs to the unit and tells the daemon of each on OWN_BSM, on a thread of its
/// own: EGO_MOTION and EGO_GNSS in, UDP and LCM out.
class OwnOutput {
 public:
  using Log = std::function<void(const std::string&)>;

  /// nullptr where nothing is to be sent, or with `error` where no socket can be opened.
  static std::unique_ptr<OwnOutput> Start(const GatewayConfig& config, Log log, std::string& error);
  ~OwnOutput();

  void OnUnitSent(std::uint32_t id, std::int64_t utime);

  struct Figures {
    OwnState state = OwnState::kOff;
    std::uint32_t id = 0;
    std::int64_t sent = 0;
    std::int64_t failures = 0;
  };
  [[nodiscard]] Figures figures() const;

 private:
  OwnOutput(const GatewayConfig& config, Log log, int socket);
  void Run();
  bool Open();
  void Step();

  OwnBsmConfig config_;
  std::string out_url_;
  Log log_;
  int socket_;
  std::unique_ptr<LcmBus> in_, out_;
  std::vector<std::uint8_t> bytes_;
  mutable std::mutex mutex_;  // Sender and failures.
  OwnSender sender_;
  std::int64_t failures_ = 0;
  OwnState told_ = OwnState::kOff;
  std::atomic<bool> must_stop_ = false;
  std::thread thread_;
};

}  // namespace v2vouch::obu
