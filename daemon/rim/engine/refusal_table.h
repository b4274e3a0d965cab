// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// What was refused since start, by channel, reason and field. Bounded, whatever comes: beyond
/// kMostRows a refusal is counted without channel and field; beyond kMostUnknownChannels names the
/// other unknown channels share one row, as do names in a field (RefusalTally::AddNamed) beyond
/// kMostNames. Rows stay in the order in which they first occurred.
class RefusalTable {
 public:
  using Row = wire::RefusalDetail;
  static constexpr std::size_t kMostRows = 192;
  static constexpr std::size_t kMostUnknownChannels = 16;
  static constexpr std::size_t kMostNames = 24;
  static constexpr std::string_view kOtherChannels = "(others)";

  void Add(std::string_view channel, const Refusal& refusal, std::uint64_t count = 1,
           std::string_view text = {});

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

 private:
  Row* Find(std::string_view channel, const Refusal& refusal, std::string_view text);

  std::vector<Row> rows_;
  std::size_t unknown_channels_ = 0;
  std::size_t names_ = 0;
};

/// The refusal with a field, where the reason alone tells which: "utime" of what is too old.
Refusal WithField(Refusal refusal, wire::InputKind kind);

}  // namespace v2vouch
