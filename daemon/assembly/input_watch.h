// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/base/time.h"
#include "daemon/wire/input_decoder.h"
#include "daemon/wire/status.h"

namespace v2vouch {

/// Health of every input channel in message time: counts, losses by the sequence counter, rate, age
/// against the newest of all own sensors, silence. A function of the messages alone.
class InputWatch {
 public:
  explicit InputWatch(std::span<const wire::InputChannel> channels);

  void Received(std::size_t channel);
  void Accepted(std::size_t channel, Timestamp stamp, std::int64_t seq);
  /// All own sensors stepped back: ages start again from the next message.
  void Restart();

  /// Newest stamp of any own sensor (BSMs and GNSS do not set the clock).
  [[nodiscard]] std::optional<Timestamp> newest_own() const { return newest_own_; }
  [[nodiscard]] std::int64_t accepted() const { return accepted_; }

  /// Rates are over the message time since the last call.
  void Report(std::vector<wire::InputStatus>& inputs);

 private:
  struct Watched {
    wire::InputChannel channel;
    std::int64_t received = 0;
    std::int64_t accepted = 0;
    std::int64_t gaps = 0;
    std::int64_t reported = 0;  // `accepted` at the last report.
    std::optional<std::int64_t> seq{};
    std::optional<Timestamp> newest{};
  };

  std::vector<Watched> inputs_;
  std::optional<Timestamp> newest_own_;
  std::optional<Timestamp> last_report_;
  std::int64_t accepted_ = 0;
};

}  // namespace v2vouch
