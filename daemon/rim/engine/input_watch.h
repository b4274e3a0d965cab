// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/base/time.h"
#include "daemon/rim/wire/input_decoder.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// Health of every input channel: counts, losses by the sequence counter, rate, age, silence.
/// Ages and rates are by arrival (socket or log time), so that no wrong stamp can make an input
/// look alive or another one silent. Arrival that goes back, as a log's does where the host's clock
/// was set, stands still here; a leap forward counts as kLongestLeap_s.
class InputWatch {
 public:
  explicit InputWatch(std::span<const wire::InputChannel> channels);

  /// A message arrived, or nothing did and it is `at` now.
  void Received(std::size_t channel, Timestamp at);
  void AdvanceTo(Timestamp at);
  void Accepted(std::size_t channel, Timestamp stamp, std::int64_t seq);
  /// Everything starts again: so do the counters.
  void Restart();

  /// Time of arrival that has passed since the first message.
  [[nodiscard]] Duration elapsed() const { return elapsed_; }
  [[nodiscard]] std::int64_t accepted() const { return accepted_; }

  /// Rates are over the time of arrival since the last call.
  void Report(std::vector<wire::InputStatus>& inputs);
  /// Configured sources, ego motion and GNSS that have been silent for a second and five periods.
  void CollectNotices(std::vector<Notice>& notices) const;

  static constexpr double kLongestLeap_s = 10.0;

 private:
  struct Watched {
    wire::InputChannel channel;
    std::int64_t received = 0;
    std::int64_t accepted = 0;
    std::int64_t gaps = 0;
    std::int64_t reported = 0;             // `accepted` at the last report.
    std::optional<std::int64_t> seq{};     // Of the newest stamp.
    std::optional<Timestamp> newest{};     // Accepted stamp.
    std::optional<Duration> last_heard{};  // In elapsed time.
  };

  std::vector<Watched> inputs_;
  std::optional<Timestamp> last_arrival_;
  Duration elapsed_{0};
  std::optional<Duration> last_report_;
  std::int64_t accepted_ = 0;
};

}  // namespace v2vouch
