// SPDX-License-Identifier: Apache-2.0
#include "sim/run_log/log_facts.h"

#include <algorithm>
#include <map>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/daemon_status_t.hpp"

namespace v2vouch::evaluation {
namespace {

constexpr std::size_t kMostChannels = 256;
constexpr std::int64_t kMostSeconds = 100'000;  // Later ones are counted in the total only.

}  // namespace

bool ReadLogFacts(const std::string& path, LogFacts& facts, std::string& error) {
  facts = {};
  const auto reader = LogReader::Open(path, error);
  if (!reader) return false;
  std::map<std::string, LogFacts::Channel> channels;
  LogEvent event;
  bool is_first = true;
  while (reader->Next(event)) {
    if (is_first) facts.begin = event.received;
    is_first = false;
    const auto found = channels.find(event.channel);
    if (found == channels.end() && channels.size() >= kMostChannels) continue;
    LogFacts::Channel& channel = channels[event.channel];
    ++channel.messages;
    const auto second = (ToMicros(event.received) - ToMicros(facts.begin)) / 1'000'000;
    if (second >= 0 && second < kMostSeconds) {
      if (channel.per_second.size() <= static_cast<std::size_t>(second)) {
        channel.per_second.resize(static_cast<std::size_t>(second) + 1);
      }
      ++channel.per_second[static_cast<std::size_t>(second)];
    }
    const auto status = wire::Decode<daemon_status_t>(event.bytes);
    if (!status) continue;
    facts.has_status = true;
    facts.refusals.clear();
    for (const refusal_t& refusal : status->refusal_details) {
      facts.refusals.push_back({refusal.channel, refusal.reason, refusal.field, refusal.count});
    }
  }
  for (auto& [name, channel] : channels) {
    channel.name = name;
    facts.channels.push_back(std::move(channel));
  }
  std::ranges::stable_sort(facts.refusals, std::ranges::greater{}, &LogFacts::Refusal::count);
  return true;
}

}  // namespace v2vouch::evaluation
