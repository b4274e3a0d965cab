// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/programs/mcap/view_messages.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/mcap/writer.h"

namespace v2vouch::mcap_export {

/// View flavour, for Foxglove, Lichtblick, PlotJuggler: every message of our types as JSON with a
/// JSON Schema on the topic of its channel, and what can be drawn once more as Foxglove's own
/// messages (view_messages.h). Pictures are there only in the latter form. Not to be turned
/// back: messages of other types, and those that do not decode, are counted and left out.
class ViewWriter {
 public:
  explicit ViewWriter(mcap::Writer& writer) : writer_(writer) {}
  void Write(const LogEvent& event);
  [[nodiscard]] std::int64_t left_out() const { return left_out_; }

 private:
  void WriteJson(const std::string& topic, const std::string& schema, std::string_view schema_text,
                 std::string_view json, Timestamp received);

  mcap::Writer& writer_;
  ViewMessages messages_;
  std::map<std::string, std::uint16_t> schemas_;
  std::map<std::pair<std::string, std::uint16_t>, std::uint16_t> channels_;
  std::map<std::uint16_t, std::uint32_t> sequences_;
  std::int64_t left_out_ = 0;
};

}  // namespace v2vouch::mcap_export
