// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <v2vouch/bsm_t.hpp>
#include <v2vouch/truth_bsm_t.hpp>
#include <vector>

#include "daemon/rim/wire/codec.h"
#include "sim/simulation/simulation.h"

namespace v2vouch::sim {

/// Messages on their way to the ego's computer, handed out in order of arrival.
class ArrivalQueue {
 public:
  template <class T>
  void Send(const std::string& channel, std::int64_t stamp_utime, Timestamp arrival,
            const T& message) {
    Pending pending;
    pending.event.arrival = arrival;
    pending.event.channel = channel;
    pending.stamp_utime = stamp_utime;
    wire::Encode(message, pending.event.bytes);
    queue_.push_back(std::move(pending));
  }
  /// A BSM, numbered and encoded when its turn comes; its truth follows right behind it.
  /// @param is_cut half of its bytes arrive.
  void Pend(const bsm_t& bsm, std::optional<truth_bsm_t> truth, bool is_cut = false);
  /// Appends what arrives before a time.
  void Deliver(Timestamp before, std::vector<SimEvent>& events);

 private:
  struct Pending {
    SimEvent event;
    std::int64_t stamp_utime = 0;
    std::optional<bsm_t> bsm;  // Numbered and encoded when its turn comes.
    std::optional<truth_bsm_t> truth;
    bool is_cut = false;  // Half of its bytes arrive.
  };

  std::int64_t bsm_seq_ = 0;
  std::vector<Pending> queue_;
};

}  // namespace v2vouch::sim
