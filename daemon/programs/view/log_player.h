// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/rim/io/arrival_clock.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/view/playback.h"
#include "daemon/rim/view/scene.h"

namespace v2vouch {

/// The configuration that the daemon stored with a log (V2VOUCH_CONFIG among its first thousand
/// events); "" = none.
std::string ConfigIn(const std::string& log);

/// Plays a log of any size into a scene. The log is read once at start: where in the file each
/// quarter of a second begins, and what happened, for the time line. Memory: 40 bytes per mark.
/// A recorder's clock that was set back does not fold the drive over itself (ArrivalClock).
class LogPlayer : public view::Player {
 public:
  using Progress = std::function<bool(double share)>;  ///< False: stop.

  /// @return nullptr with `error` set. Fills the scene's events and map.
  static std::unique_ptr<LogPlayer> Open(const std::string& path, view::Scene& scene,
                                         const Progress& progress, std::string& error);

  void Control(const view::PlaybackRequest& request) override;
  [[nodiscard]] view::PlaybackState state() const override { return state_; }

  /// Moves on by the time since the last call.
  void Advance(std::chrono::steady_clock::time_point now);
  [[nodiscard]] std::int64_t damaged() const { return damaged_; }
  /// Whether the log holds lists; one of inputs alone shows no vehicle.
  [[nodiscard]] bool has_lists() const { return has_lists_; }

 private:
  struct Mark {
    std::int64_t received_us = 0;
    std::int64_t offset = 0;
    ArrivalClock clock;  // Before the event there.
  };
  LogPlayer(std::unique_ptr<LogReader> reader, view::Scene& scene)
      : reader_(std::move(reader)), scene_(scene) {}
  bool Index(const Progress& progress);
  void Seek(std::int64_t target_us);
  bool PlayUntil(std::int64_t target_us, std::chrono::steady_clock::time_point deadline);

  std::unique_ptr<LogReader> reader_;
  view::Scene& scene_;
  std::vector<Mark> marks_;
  view::PlaybackState state_;
  LogEvent next_;
  ArrivalClock clock_;
  bool has_next_ = false;
  std::int64_t damaged_ = 0;
  bool has_lists_ = false;
  std::chrono::steady_clock::time_point advanced_{};
};

}  // namespace v2vouch
