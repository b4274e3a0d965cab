// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation/arrival_queue.h"

#include <algorithm>

namespace v2vouch::sim {

void ArrivalQueue::Pend(const bsm_t& bsm, std::optional<truth_bsm_t> truth, bool is_cut) {
  Pending pending;
  pending.event.arrival = FromMicros(bsm.rx_utime);
  pending.event.channel = "BSM";
  pending.stamp_utime = bsm.generation_utime;
  pending.bsm = bsm;
  pending.truth = std::move(truth);
  pending.is_cut = is_cut;
  queue_.push_back(std::move(pending));
}

void ArrivalQueue::Deliver(Timestamp before, std::vector<SimEvent>& events) {
  // Ties: by channel, then stamp; the sort is stable, so one sender's messages keep their order.
  std::stable_sort(queue_.begin(), queue_.end(), [](const Pending& a, const Pending& b) {
    if (a.event.arrival != b.event.arrival) return a.event.arrival < b.event.arrival;
    if (a.event.channel != b.event.channel) return a.event.channel < b.event.channel;
    return a.stamp_utime < b.stamp_utime;
  });
  std::size_t count = 0;
  for (; count < queue_.size() && queue_[count].event.arrival < before; ++count) {
    Pending& pending = queue_[count];
    if (pending.bsm) {
      pending.bsm->seq = bsm_seq_++;
      wire::Encode(*pending.bsm, pending.event.bytes);
      if (pending.is_cut) pending.event.bytes.resize(pending.event.bytes.size() / 2);
    }
    events.push_back(std::move(pending.event));
    if (pending.truth) {
      pending.truth->seq = bsm_seq_ - 1;
      SimEvent beside{events.back().arrival, "TRUTH_BSM", {}};
      wire::Encode(*pending.truth, beside.bytes);
      events.push_back(std::move(beside));
    }
  }
  queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace v2vouch::sim
