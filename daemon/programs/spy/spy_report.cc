// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/spy_report.h"

#include <cinttypes>
#include <cmath>
#include <nlohmann/json.hpp>

#include "daemon/programs/spy/plain_words.h"
#include "daemon/programs/spy/printable.h"

namespace v2vouch::spy {
namespace {

std::string TypeText(const ChannelRow& row) {
  if (row.type != nullptr) return std::string(row.type->name);
  return Format("%016" PRIx64, row.fingerprint);
}

double AgeOf(const Moment& moment, const ChannelRow& row) {
  return 1e-6 * (static_cast<double>(moment.now_us) - static_cast<double>(row.last_us));
}

double RateOf(const Moment& moment, const ChannelRow& row) {
  return moment.is_log ? row.MeanRate() : row.Rate(moment.now_us);
}

double BytesPerSecond(const Moment& moment, const ChannelRow& row) {
  if (!moment.is_log) return row.BytesPerSecond(moment.now_us);
  return row.messages > 0
             ? row.MeanRate() * static_cast<double>(row.bytes) / static_cast<double>(row.messages)
             : 0.0;
}

std::string NumberText(double value, const char* format) {
  return std::isfinite(value) ? Format(format, value) : "-";
}

std::int64_t RefusedOf(const ChannelRow& row) {
  std::int64_t sum = 0;
  for (const auto& [reason, count] : row.refused) sum += count;
  return sum;
}

nlohmann::json Number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace

std::vector<std::string> TableLines(const Moment& moment, const std::string& filter,
                                    bool is_narrow) {
  const auto line = [&](const std::string& channel, const std::string& type,
                        const std::string& messages, const std::string& rest) {
    if (is_narrow) return Format("%-24s", channel.c_str()) + rest;
    return Format("%-24s %-22s %9s", channel.c_str(), type.c_str(), messages.c_str()) + rest;
  };
  std::vector<std::string> lines;
  lines.push_back(line("channel", "type", "messages",
                       Format(" %8s %8s %8s %10s %6s %8s", "Hz", "jitter",
                              moment.is_log ? "" : "age", "bytes/s", "lost", "refused")));
  for (const auto& [channel, row] : moment.table->rows()) {
    if (channel.find(filter) == std::string::npos) continue;
    const double bytes = BytesPerSecond(moment, row);
    lines.push_back(line(
        Printable(channel, 40), TypeText(row), std::to_string(row.messages),
        Format(" %8s %8s %8s %10s %6lld %8lld", NumberText(RateOf(moment, row), "%.1f").c_str(),
               DurationText(row.Jitter()).c_str(),
               moment.is_log ? "" : DurationText(AgeOf(moment, row)).c_str(),
               std::isfinite(bytes) ? BytesText(bytes).c_str() : "-",
               static_cast<long long>(row.gaps), static_cast<long long>(RefusedOf(row)))));
  }
  return lines;
}

std::vector<std::string> RefusalLines(const Moment& moment) {
  std::vector<std::string> lines;
  for (const auto& [channel, row] : moment.table->rows()) {
    for (const auto& [reason, count] : row.refused) {
      lines.push_back(Format("%lld messages of ", static_cast<long long>(count)) +
                      Printable(channel, 63) + ": " + reason);
    }
    if (row.repeats > 0) {
      lines.push_back(Format("%lld messages of ", static_cast<long long>(row.repeats)) +
                      Printable(channel, 63) + ": seq stood still or went back");
    }
  }
  for (std::size_t i = 1; i < moment.packets.size(); ++i) {
    if (moment.packets[i] == 0) continue;
    const auto name = lcm_packets::NameOf(static_cast<lcm_packets::PacketFault>(i));
    lines.push_back(Format("%llu datagrams: ", static_cast<unsigned long long>(moment.packets[i])) +
                    std::string(name.reason) + ' ' + std::string(name.field));
  }
  if (moment.kernel_drops > 0) {
    lines.push_back(Format("%lld datagrams dropped by the kernel: raise net.core.rmem_max",
                           static_cast<long long>(moment.kernel_drops)));
  }
  return lines;
}

std::string JsonOf(const Moment& moment) {
  using nlohmann::json;
  json channels = json::array();
  json status = json::array();
  for (const auto& [channel, row] : moment.table->rows()) {
    json entry = {{"channel", channel},
                  {"type", row.type != nullptr ? json(std::string(row.type->name)) : json(nullptr)},
                  {"fingerprint", Format("%016" PRIx64, row.fingerprint)},
                  {"messages", row.messages},
                  {"bytes", row.bytes},
                  {"rate_hz", Number(RateOf(moment, row))},
                  {"jitter_s", Number(row.Jitter())},
                  {"age_s", moment.is_log ? json(nullptr) : Number(AgeOf(moment, row))},
                  {"bytes_per_s", Number(BytesPerSecond(moment, row))},
                  {"lost", row.gaps},
                  {"repeats", row.repeats},
                  {"utime", row.stamp_us ? json(*row.stamp_us) : json(nullptr)},
                  {"refused", json::object()}};
    for (const auto& [reason, count] : row.refused) entry["refused"][reason] = count;
    channels.push_back(std::move(entry));
    for (const std::string& line : StatusWords(row.newest)) status.push_back(line);
  }
  json datagrams = json::object();
  for (std::size_t i = 1; i < moment.packets.size(); ++i) {
    if (moment.packets[i] == 0) continue;
    const auto name = lcm_packets::NameOf(static_cast<lcm_packets::PacketFault>(i));
    datagrams[std::string(name.reason) + ' ' + std::string(name.field)] = moment.packets[i];
  }
  const json report = {{"channels", channels},
                       {"datagrams_refused", datagrams},
                       {"kernel_drops", moment.kernel_drops},
                       {"damaged", moment.damaged},
                       {"status", status}};
  return report.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

}  // namespace v2vouch::spy
