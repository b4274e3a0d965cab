// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/warn/warn_live.h"

#include <chrono>
#include <cstdio>
#include <map>
#include <utility>

#include "daemon/programs/warn/warn_log.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/warnings_wire/warnings_conversion.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch {
namespace {

using SteadyClock = std::chrono::steady_clock;

// Tells once per warning and level.
class Teller {
 public:
  void Tell(const warnings::WarningList& list) {
    for (const warnings::Warning& warning : list.warnings) {
      const auto key = std::pair(warning.kind, ToMicros(warning.since));
      const auto [known, is_new] = told_.try_emplace(key, warnings::Level::kInfo);
      if (known->second >= warning.level) continue;
      known->second = warning.level;
      std::printf("%lld %s\n", static_cast<long long>(ToMicros(list.stamp)),
                  WarningLine(warning).c_str());
      std::fflush(stdout);
    }
    if (list.warnings.empty()) told_.clear();
  }

 private:
  std::map<std::pair<warnings::Kind, std::int64_t>, warnings::Level> told_;
};

}  // namespace

int WarnLive(const std::string& lcm_url, const WarnFile& file, bool is_told) {
  const auto bus = LcmBus::Open(lcm_url);
  if (!bus) {
    std::fprintf(stderr, "v2vouch-warn: LCM cannot be opened at %s\n",
                 lcm_url.empty() ? "its default URL" : lcm_url.c_str());
    return 1;
  }
  wire::WarnFeed feed(file.channels, file.warnings, file.body());
  Teller teller;
  std::vector<std::uint8_t> bytes;
  auto last_list = SteadyClock::now();
  auto last_out = last_list;
  const auto send = [&](const warnings::WarningList& list) {
    wire::Encode(wire::ToMessage(list), bytes);
    bus->Publish(file.channels.warnings, bytes);
    last_out = SteadyClock::now();
    if (is_told) teller.Tell(list);
  };
  const auto& channels = file.channels;
  for (const std::string& channel : {channels.tracks_local, channels.tracks_priority,
                                     channels.ego_motion, channels.ego_intent}) {
    const bool is_heard = bus->Subscribe(
        channel, [&, channel](std::span<const std::uint8_t> data, std::size_t, Timestamp) {
          if (const auto list = feed.Take(channel, data)) {
            last_list = SteadyClock::now();
            send(*list);
          }
        });
    if (!is_heard) {
      std::fprintf(stderr, "v2vouch-warn: cannot listen to %s\n", channel.c_str());
      return 1;
    }
  }
  constexpr auto kSilent = std::chrono::milliseconds(300);
  constexpr auto kHeartbeat = std::chrono::milliseconds(100);
  while (!IsStopAsked()) {
    if (!bus->Handle(50)) {
      std::fprintf(stderr, "v2vouch-warn: the bus is broken\n");
      return 1;
    }
    const auto now = SteadyClock::now();
    if (now - last_list > kSilent && now - last_out >= kHeartbeat) send(feed.Silence());
  }
  std::fprintf(stderr, "v2vouch-warn: %lld messages, %lld refused\n",
               static_cast<long long>(feed.taken()), static_cast<long long>(feed.refused()));
  return 0;
}

}  // namespace v2vouch
