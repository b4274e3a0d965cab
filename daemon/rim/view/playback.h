// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace v2vouch::view {

/// What a client asks of a recorded drive (Foxglove's playbackControl).
struct PlaybackRequest {
  bool play = true;
  double speed = 1.0;
  std::optional<std::int64_t> seek_us;  ///< Arrival time in the log.
  std::string id;                       ///< Comes back in the answer.
};

/// Where a recorded drive stands. Times are arrival times of the log, microseconds.
struct PlaybackState {
  enum class Status : std::uint8_t { kPlaying = 0, kPaused = 1, kBuffering = 2, kEnded = 3 };
  Status status = Status::kPlaying;
  std::int64_t now_us = 0;
  double speed = 1.0;
  std::int64_t begin_us = 0;
  std::int64_t end_us = 0;
  std::int64_t seeks = 0;    ///< Counts jumps.
  std::int64_t changes = 0;  ///< Counts changes of status, speed and jumps.
};

/// A recorded drive that can be played. A live source has none.
class Player {
 public:
  virtual ~Player() = default;
  virtual void Control(const PlaybackRequest& request) = 0;
  [[nodiscard]] virtual PlaybackState state() const = 0;
};

}  // namespace v2vouch::view
