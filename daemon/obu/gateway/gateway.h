// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/gateway/copy_filter.h"
#include "daemon/obu/gateway/gateway_config.h"
#include "daemon/obu/gateway/receptions.h"
#include "v2vouch/obu_status_t.hpp"

namespace v2vouch::obu {

/// A datagram as a socket gave it, or a packet as a network interface did.
struct Arrival {
  Bytes bytes;
  std::string_view source;  ///< Address of the sender, as text; of a packet, the interface.
  std::size_t input = 0;    ///< Index of the configuration's inputs.
  std::int64_t utime = 0;   ///< Reception, us UTC.
  bool is_cut = false;      ///< Longer than the buffer.
  int link_type = -1;       ///< Of a packet, as libpcap numbers them.
};

/// From datagrams to messages for channel BSM, with counts of everything. Reads no clock and opens
/// no socket: time comes with the datagrams.
class Gateway {
 public:
  Gateway(const GatewayConfig& config, TrustAnchors anchors, std::int64_t started_utime);

  void OnDatagram(const Arrival& arrival, std::vector<bsm_t>& out);
  void Flush(std::int64_t utime, std::vector<bsm_t>& out) { copies_.Flush(utime, out); }
  [[nodiscard]] std::optional<std::int64_t> due() const { return copies_.due(); }

  /// TemporaryID of a BSM that the unit reported as sent by itself, once.
  std::optional<std::uint32_t> TakeUnitSent() { return std::exchange(unit_sent_, std::nullopt); }

  /// For OBU_STATUS; what only the sockets know is left to the caller.
  obu_status_t Status(std::int64_t utime);

  /// What is worth a line in the log since the last call: unknown framings with their first bytes,
  /// at most one in ten seconds.
  std::vector<std::string> TakeLog();

 private:
  static constexpr std::size_t kMostSources = 64;
  struct Source {
    std::int64_t datagrams = 0;
    std::int64_t second = 0;
    int in_second = 0;
  };
  Source& SourceOf(std::string_view address);
  void Read(const Arrival& arrival, Datagram& datagram);
  void Refuse(std::string_view reason) { ++refusals_[std::string(reason)]; }
  void Publish(const Arrival& arrival, Datagram& datagram, std::vector<bsm_t>& out);
  void NoteClock(std::int64_t utime, std::int64_t generation_utime);

  GatewayConfig config_;
  std::vector<std::optional<Layer>> framings_;
  Receptions receptions_;
  CopyFilter copies_;
  std::array<std::uint8_t, kLongestDatagram> scratch_{};

  std::int64_t last_utime_;
  std::int64_t datagrams_ = 0;
  std::int64_t published_ = 0;
  std::int64_t duplicates_ = 0;
  std::int64_t status_seq_ = 0;
  std::map<std::string, std::int64_t> framing_counts_, refusals_, signatures_;
  std::map<std::string, Source, std::less<>> sources_;
  std::map<std::uint32_t, std::int64_t> senders_;  // Id -> last heard.
  std::deque<std::int64_t> clock_offsets_us_;      // The latest 101.
  std::optional<std::uint32_t> unit_sent_;
  std::vector<std::string> log_;
  std::int64_t logged_utime_ = 0;
};

}  // namespace v2vouch::obu
