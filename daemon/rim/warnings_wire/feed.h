// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "daemon/warnings/warner.h"

namespace v2vouch::wire {

struct WarnChannels {
  std::string tracks_local = "TRACKS_LOCAL";
  std::string tracks_priority = "TRACKS_PRIORITY";
  std::string ego_motion = "EGO_MOTION";
  std::string ego_intent = "EGO_INTENT";
  std::string warnings = "WARNINGS";

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("tracks_local", tracks_local);
    a.Text("tracks_priority", tracks_priority);
    a.Text("ego_motion", ego_motion);
    a.Text("ego_intent", ego_intent);
    a.Text("warnings", warnings);
  }
};

/// Bytes of the four channels into the warner: the same for a bus and for a log.
class WarnFeed {
 public:
  WarnFeed(const WarnChannels& channels, const warnings::WarningsConfig& config,
           const warnings::EgoBody& body)
      : channels_(channels), warner_(config, body) {}

  /// @return the warnings that this message led to. A message that does not decode is counted.
  std::optional<warnings::WarningList> Take(const std::string& channel,
                                            std::span<const std::uint8_t> bytes);
  [[nodiscard]] warnings::WarningList Silence() { return warner_.Silence(); }
  [[nodiscard]] std::int64_t taken() const { return taken_; }
  [[nodiscard]] std::int64_t refused() const { return refused_; }

 private:
  WarnChannels channels_;
  warnings::Warner warner_;
  std::int64_t taken_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace v2vouch::wire
