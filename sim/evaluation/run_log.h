// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/evaluation/scene_specs.h"
#include "sim/evaluation/truth.h"

namespace v2vouch::evaluation {

enum class ListKind { kLocal = 0, kV2v = 1, kPriority = 2 };
inline constexpr std::array<ListKind, 3> kLists = {ListKind::kLocal, ListKind::kV2v,
                                                   ListKind::kPriority};
constexpr std::size_t Index(ListKind kind) { return static_cast<std::size_t>(kind); }
const char* ListKey(ListKind kind);    ///< "local", "v2v", "priority".
const char* ListTitle(ListKind kind);  ///< "LOCAL", "V2V", "PRIORITY".

/// One vehicle of a received list; motion in the ego's body frame at the list's time, speed over
/// ground.
struct ListedTrack {
  std::int64_t id = 0;
  std::int64_t local_id = 0;
  PlanarMotion motion_B;
  Eigen::Matrix2d position_covariance_B = Eigen::Matrix2d::Identity();
  double length_m = 0.0;
  double width_m = 0.0;
  int object_class = 0;
  std::uint32_t sender = 0;
  Timestamp start{};   ///< When the track began.
  int visibility = 0;  ///< Constants of track_t: visible, hidden, out of view.
  int trust = 0;       ///< Constants of track_t; of the sender, where there is one.
};

struct ReceivedList {
  Timestamp received{};
  Timestamp stamp{};
  bool is_stale = false;
  std::vector<ListedTrack> tracks;
};

/// One measurement cycle of an own sensor.
struct SensorLook {
  Timestamp received{};
  Timestamp stamp{};
  std::size_t sensor = 0;  ///< Index into SceneSpecs::sensors.
};

struct BsmArrival {
  Timestamp received{};
  std::uint32_t sender = 0;
};

/// A verdict about a sender, as published.
struct VerdictReport {
  Timestamp received{};
  std::uint32_t sender = 0;
  std::string check;
};

/// Everything evaluation takes from a log, each in order of arrival.
struct RunLog {
  std::string path;
  Truth truth;
  SceneSpecs specs;
  std::array<std::vector<ReceivedList>, 3> lists;  ///< By ListKind.
  std::vector<SensorLook> looks;
  std::vector<BsmArrival> bsms;
  std::vector<VerdictReport> reports;
  std::int64_t events = 0;
  std::int64_t refused = 0;  ///< Messages that did not decode.
  std::int64_t damaged = 0;  ///< Damaged stretches of the file.
  double log_seconds = 0.0;
};

/// Reads a recorded run: the three lists, TRUTH, SIM_SCENARIO, and the arrival times of own sensor
/// frames and BSMs. Tracks that are not confirmed, and states that are not finite, are left out
/// (the latter counted as refused).
/// @param progress called now and then with the share read, 0..1; may be empty.
/// @return false with `error` set when the file cannot be read.
bool ReadRunLog(const std::string& path, const std::function<void(double)>& progress, RunLog& log,
                std::string& error);

/// The newest list received by `t`, or null.
const ReceivedList* NewestBy(const std::vector<ReceivedList>& lists, Timestamp t);

}  // namespace v2vouch::evaluation
