// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/gateway/gateway.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/common/base/big_endian.h"
#include "daemon/common/base/fnv1a.h"
#include "daemon/common/base/hex_text.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kSenderMemory_us = 5000000;  // Silent for longer: not counted.
constexpr std::size_t kMostSenders = 16384;         // Counted; a flood of ids takes no more.
constexpr std::size_t kClockSamples = 101;          // Of the median.
constexpr std::size_t kFewestClockSamples = 10;     // Fewer make no verdict.
constexpr std::int64_t kLogPause_us = 10000000;     // Between two lines of a kind.

// Equal for copies of one message, whichever way they came. The signature belongs to it: who
// repeats a message without or with another must not displace the true one.
std::uint64_t KeyOf(const Datagram& datagram) {
  Fnv1a key;
  if (datagram.dot2 && datagram.dot2->content == Dot2Data::Content::kSigned) {
    key.Add(datagram.dot2->to_be_signed);
    key.Add(datagram.dot2->signature.s);
  } else if (datagram.frame) {
    key.Add(datagram.frame->value);
  } else if (datagram.cam) {
    const Cam& cam = *datagram.cam;
    for (const std::int64_t figure :
         {std::int64_t{cam.station_id}, std::int64_t{cam.generation_delta_time},
          std::int64_t{cam.latitude}, std::int64_t{cam.longitude}, std::int64_t{cam.speed},
          std::int64_t{cam.heading}}) {
      key.Add(figure);
    }
  }
  return key.value();
}

std::string HexOfFirst(Bytes bytes) {
  return HexText(bytes.first(std::min<std::size_t>(bytes.size(), 16)));
}

std::vector<count_t> Listed(const std::map<std::string, std::int64_t>& counts) {
  std::vector<count_t> listed;
  for (const auto& [name, count] : counts) {
    listed.emplace_back();
    listed.back().name = name;
    listed.back().count = count;
  }
  return listed;
}

}  // namespace

Gateway::Gateway(const GatewayConfig& config, TrustAnchors anchors, std::int64_t started_utime)
    : config_(config),
      receptions_({.most_certificates = static_cast<std::size_t>(config.security.certificates),
                   .checks_per_s = config.security.checks_per_s},
                  std::move(anchors)),
      copies_(static_cast<std::int64_t>(config.duplicate_s * 1e6),
              static_cast<std::int64_t>(config.merge_s * 1e6)),
      last_utime_(started_utime) {
  for (const InputConfig& input : config.inputs) framings_.push_back(LayerOfName(input.framing));
}

Gateway::Source& Gateway::SourceOf(std::string_view address) {
  const auto found = sources_.find(address);
  if (found != sources_.end()) return found->second;
  if (sources_.size() >= kMostSources) return sources_["(others)"];
  return sources_[std::string(address)];
}

void Gateway::NoteClock(std::int64_t utime, std::int64_t generation_utime) {
  if (generation_utime == 0) return;
  clock_offsets_us_.push_back(utime - generation_utime);
  if (clock_offsets_us_.size() > kClockSamples) clock_offsets_us_.pop_front();
}

void Gateway::Read(const Arrival& arrival, Datagram& datagram) {
  const InputConfig& input = config_.inputs.at(arrival.input);
  const DatagramOptions options{framings_.at(arrival.input), input.allow_text,
                                static_cast<std::uint16_t>(input.port)};
  if (arrival.link_type < 0) {
    ReadDatagram(arrival.bytes, options, scratch_, datagram);
  } else {
    ReadPacket(arrival.link_type, arrival.bytes, options, scratch_, datagram);
  }
}

void Gateway::OnDatagram(const Arrival& arrival, std::vector<bsm_t>& out) {
  ++datagrams_;
  last_utime_ = std::max(last_utime_, arrival.utime);
  const InputConfig& input = config_.inputs.at(arrival.input);
  Datagram datagram;
  std::string address(arrival.source);
  // A packet tells its sender inside; one off the air has none.
  const bool is_packet = arrival.link_type >= 0;
  if (is_packet) {
    Read(arrival, datagram);
    if (datagram.udp) address = datagram.udp->source_text();
  }
  const bool has_address = !is_packet || datagram.udp;
  Source& source = SourceOf(address);
  ++source.datagrams;
  if (has_address && !input.allow.empty() &&
      std::ranges::find(input.allow, address) == input.allow.end()) {
    return Refuse("source_not_allowed");
  }
  const std::int64_t second = arrival.utime / 1000000;
  if (source.second != second) source.in_second = 0;
  source.second = second;
  if (++source.in_second > config_.most_per_source_per_s) return Refuse("over_rate");
  if (arrival.is_cut) return Refuse(FaultName(FaultKind::kTooLong));

  if (!is_packet) Read(arrival, datagram);
  if (datagram.fault) {
    Refuse(FaultName(datagram.fault.kind));
    if (datagram.fault.kind == FaultKind::kOwnTransmission && datagram.bsm) {
      unit_sent_ = datagram.bsm->core.id;
    }
    if (datagram.fault.kind == FaultKind::kUnknownFraming &&
        arrival.utime - logged_utime_ > kLogPause_us) {
      logged_utime_ = arrival.utime;
      log_.push_back("event=unknown_framing source=" + address + " bytes=" +
                     std::to_string(arrival.bytes.size()) + " first=" + HexOfFirst(arrival.bytes));
    }
    return;
  }
  Publish(arrival, datagram, out);
}

void Gateway::Publish(const Arrival& arrival, Datagram& datagram, std::vector<bsm_t>& out) {
  const std::uint64_t key = KeyOf(datagram);
  if (copies_.IsCopy(key, arrival.utime)) {
    ++duplicates_;
    copies_.Strengthen(key, datagram.rssi_dbm());
    return;
  }
  const Receptions::Heard heard = receptions_.Of(datagram, arrival.utime, published_ + 1);
  const bsm_t message = BsmMessage(datagram, heard.reception);
  copies_.Add(key, message, out);
  ++published_;
  ++framing_counts_[std::string(LayerName(*datagram.layers.begin()))];
  ++signatures_[std::string(FindingName(heard.judgement.finding))];
  NoteClock(arrival.utime, message.generation_utime);
  const std::uint32_t id = BigEndian32(message.id);
  if (senders_.size() < kMostSenders || senders_.contains(id)) senders_[id] = arrival.utime;
}

obu_status_t Gateway::Status(std::int64_t utime) {
  obu_status_t status{};
  status.utime = utime;
  status.seq = ++status_seq_;
  status.version = V2VOUCH_VERSION;
  status.datagrams = datagrams_;
  status.published = published_;
  status.duplicates = duplicates_;
  status.kernel_drops = -1;
  status.receive_buffer_bytes = -1;
  std::erase_if(senders_, [utime](const auto& sender) {
    return std::abs(utime - sender.second) > kSenderMemory_us;
  });
  status.senders = static_cast<std::int32_t>(senders_.size());
  status.certificates = static_cast<std::int32_t>(receptions_.certificates());
  status.silent_s = std::max(0.0, static_cast<double>(utime - last_utime_) * 1e-6);
  status.obu_silent = status.silent_s > config_.silent_s ? 1 : 0;
  status.clock_offset_s = std::numeric_limits<double>::quiet_NaN();
  if (clock_offsets_us_.size() >= kFewestClockSamples) {
    std::vector<std::int64_t> sorted(clock_offsets_us_.begin(), clock_offsets_us_.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    status.clock_offset_s = static_cast<double>(*middle) * 1e-6;
    status.clock_suspect = std::abs(status.clock_offset_s) > config_.clock_suspect_s ? 1 : 0;
  }
  status.framings = Listed(framing_counts_);
  status.refusals = Listed(refusals_);
  status.signatures = Listed(signatures_);
  std::map<std::string, std::int64_t> sources;
  for (const auto& [address, source] : sources_) sources[address] = source.datagrams;
  status.sources = Listed(sources);
  status.num_framings = static_cast<std::int32_t>(status.framings.size());
  status.num_refusals = static_cast<std::int32_t>(status.refusals.size());
  status.num_signatures = static_cast<std::int32_t>(status.signatures.size());
  status.num_sources = static_cast<std::int32_t>(status.sources.size());
  return status;
}

std::vector<std::string> Gateway::TakeLog() { return std::exchange(log_, {}); }

}  // namespace v2vouch::obu
