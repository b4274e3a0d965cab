// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/dropped_datagrams.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "daemon/rim/lcm_packets/packet_fault.h"

namespace v2vouch {
namespace {

// In the place of a channel, for what never became a message.
constexpr const char* kBusName = "(bus)";
constexpr const char* kV2vBusName = "(v2v bus)";

}  // namespace

void DroppedDatagramTable::Take(const Receiver& own_bus, const Receiver* v2v_bus) {
  std::vector<wire::DroppedDatagrams> before = std::move(rows_);
  rows_.clear();
  TakeBus(own_bus, kBusName, own_rejoins_);
  if (v2v_bus != nullptr) TakeBus(*v2v_bus, kV2vBusName, v2v_rejoins_);
  for (const wire::DroppedDatagrams& now : rows_) {
    std::uint64_t told = 0;
    for (const wire::DroppedDatagrams& then : before) {
      if (then.bus == now.bus && then.reason == now.reason && then.field == now.field) {
        told = then.count;
      }
    }
    if (now.count == told) continue;
    spdlog::warn("event=refused channel={} reason={} field=\"{}\" count={} total={}", now.bus,
                 now.reason, now.field, now.count - told, now.count);
  }
}

void DroppedDatagramTable::TakeBus(const Receiver& bus, const char* name, std::int64_t& rejoins) {
  const lcm_packets::PacketCounts counts = bus.refused();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const auto fault = lcm_packets::NameOf(static_cast<lcm_packets::PacketFault>(i));
    rows_.push_back({name, std::string(fault.reason), std::string(fault.field), counts[i]});
  }
  if (bus.rejoins() == rejoins) return;
  rejoins = bus.rejoins();
  spdlog::warn(
      "event=multicast_rejoined bus=\"{}\" total={} hint=\"the interface had gone or lost its "
      "address\"",
      name, rejoins);
}

}  // namespace v2vouch
