// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/run_log/scene_specs.h"
#include "sim/run_log/truth.h"

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
  Timestamp start{};             ///< When the track began.
  Timestamp last_hit{};          ///< By an own sensor; 1970 = never.
  int visibility = 0;            ///< Constants of track_t: visible, hidden, out of view.
  int trust = 0;                 ///< Constants of track_t; of the sender, where there is one.
  double bridge_budget_s = 0.0;  ///< Of PRIORITY; NaN elsewhere.
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

/// What one BSM says of its vehicle, or what is true of it; world frame W, centre of the footprint.
struct BsmContent {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  ///< [m]; NaN where there is no such vehicle.
  double yaw_rad = 0.0;
  double speed_mps = 0.0;  ///< Negative in reverse.
  double accel_mps2 = 0.0;
  double length_m = 0.0;
  double width_m = 0.0;
};

/// The simulator's knowledge of one BSM (channel TRUTH_BSM).
struct BsmTruth {
  Timestamp stamp{};  ///< Reception, as the BSM's own.
  std::int64_t seq = 0;
  std::uint32_t sender = 0;
  std::int64_t vehicle = 0;  ///< TruthObject::id it speaks for; 0 = there is no such vehicle.
  std::int64_t device = 0;   ///< Who transmits, whatever it calls itself.
  bool is_attacker = false;  ///< The device is an attacker's.
  bool is_attack = false;    ///< An attack shaped this message.
  double age_s = 0.0;        ///< Of the content at reception.
  BsmContent claimed;
  BsmContent honest;
};

/// What the daemon did with one BSM (channel BSM_VERDICT).
struct BsmVerdict {
  Timestamp stamp{};  ///< Reception, as the BSM's own.
  std::int64_t seq = 0;
  std::uint32_t sender = 0;
  int trust = 0;        ///< Constants of track_t, when the message was used.
  std::string refusal;  ///< Reason; empty = accepted.
};

/// A verdict about a sender, as published.
struct VerdictReport {
  Timestamp received{};
  std::uint32_t sender = 0;
  std::string check;
  bool is_accusation = false;  ///< ACCUSE; otherwise WITHDRAW.
};

/// Everything evaluation takes from a log, each in order of arrival.
struct RunLog {
  std::string path;
  Truth truth;
  SceneSpecs specs;
  std::array<std::vector<ReceivedList>, 3> lists;  ///< By ListKind.
  std::vector<SensorLook> looks;
  std::vector<BsmArrival> bsms;
  std::vector<BsmTruth> bsm_truths;
  std::vector<BsmVerdict> bsm_verdicts;
  std::vector<VerdictReport> reports;
  std::int64_t events = 0;
  std::int64_t refused = 0;  ///< Messages that did not decode.
  /// Those among them that bear the fingerprint of another type or of another version of it.
  std::map<std::string, std::int64_t> other_types{};
  std::int64_t damaged = 0;  ///< Damaged stretches of the file.
  double log_seconds = 0.0;
  /// Where TRUTH's time steps back, or on by more than kLongestPause: the first such step.
  struct TimeStep {
    Timestamp from{};
    Timestamp to{};
  };
  std::optional<TimeStep> truth_step;
  static constexpr Duration kLongestPause = std::chrono::minutes(10);
};

enum class ReadScope {
  kAll,    ///< Everything but the messages' truths and verdicts.
  kSpoof,  ///< What spoof scoring needs: those too.
};

/// Reads a recorded run: the three lists, TRUTH, SIM_SCENARIO, and the arrival times of own sensor
/// frames and BSMs; TRUTH_BSM and BSM_VERDICT where `scope` asks for them. Tracks that are not
/// confirmed, and states that are not finite, are left out (the latter counted as refused).
/// @param progress called now and then with the share read, 0..1; may be empty.
/// @return false with `error` set when the file cannot be read.
bool ReadRunLog(const std::string& path, const std::function<void(double)>& progress, RunLog& log,
                std::string& error, ReadScope scope = ReadScope::kAll);

/// Adds the LOCAL tracks of another run of the same drive to the lists of `log` with the same
/// stamp; their ids are made distinct by `run`, above 0.
void JoinLocal(const RunLog& other, int run, RunLog& log);

/// The newest list received by `t`, or null.
const ReceivedList* NewestBy(const std::vector<ReceivedList>& lists, Timestamp t);

}  // namespace v2vouch::evaluation
