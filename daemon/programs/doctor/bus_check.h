// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/programs/doctor/advice.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/wire/input_decoder.h"
#include "v2vouch/daemon_status_t.hpp"

namespace v2vouch {

/// What comes over the buses, compared with what the vehicle file expects: silent channels, wrong
/// names and types, refused content, clocks, daemons. Pure: messages are put in, findings come out.
class BusCheck {
 public:
  explicit BusCheck(const DaemonConfig& config);

  /// @param received by this computer's wall clock.
  void Hear(std::string_view channel, std::span<const std::uint8_t> bytes, Timestamp received);
  [[nodiscard]] AdviceList Finish(std::chrono::duration<double> listened) const;

 private:
  struct Heard {
    std::int64_t count = 0;
    std::int64_t accepted = 0;
    std::map<Reason, std::int64_t> refused;
    std::string type;                // Of the newest message; "" none of ours.
    std::vector<double> lateness_s;  // Reception minus utime, where the type has one first.
  };
  void CheckInputs(AdviceList& findings, std::chrono::duration<double> listened) const;
  void CheckStrangers(AdviceList& findings) const;
  void CheckClocks(AdviceList& findings) const;
  void CheckDaemons(AdviceList& findings, std::chrono::duration<double> listened) const;

  DaemonConfig config_;
  wire::InputDecoder decoder_;
  std::map<std::string, Heard, std::less<>> heard_;
  std::int64_t statuses_ = 0;
  std::int64_t status_breaks_ = 0;  // Statuses whose counter does not follow the one before.
  std::int64_t last_status_seq_ = -1;
  daemon_status_t status_{};
};

}  // namespace v2vouch
