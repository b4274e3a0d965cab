// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "daemon/warnings/warner.h"
#include "sim/run_log/truth.h"

namespace v2vouch::evaluation {

/// Whose lists the engine is given.
enum class Consumer { kV2v = 0, kLocal = 1, kOurs = 2 };
inline constexpr std::array<Consumer, 3> kConsumers = {Consumer::kV2v, Consumer::kLocal,
                                                       Consumer::kOurs};
const char* ConsumerKey(Consumer consumer);  ///< "v2v", "local", "ours".

/// What one consumer says at one time.
struct SaidWarnings {
  Timestamp at{};  ///< When the list that led to it was received; of truth: its own time.
  warnings::WarningList list;
  /// By warning of the list: the vehicle's track is that of a sender that lied within kLinger_s.
  std::vector<bool> is_of_liar{};
};

struct WarnRun {
  std::string scenario;
  Truth truth;
  std::array<std::vector<SaidWarnings>, 3> said;  ///< By Consumer.
  std::vector<SaidWarnings> truth_said;           ///< Vehicles by TruthObject::id as local_id.
  warnings::EgoBody body;
  double seconds = 0.0;
  std::int64_t damaged = 0;  ///< Stretches of the log.
};

/// The turn signal that this ego would show: left (right) where the way it goes turns by 50 degrees
/// within the next 17 m and one second, as Euro NCAP's indicator 1 s before the curve.
warnings::EgoIntent IntentFromTruth(const Truth& truth, Timestamp t);

/// Reads a replayed log and runs the engine four times. V2V alone is TRACKS_V2V taken for true,
/// without covariance.
/// @return false with `error` set where the log holds no TRUTH or no lists.
bool RunWarnings(const std::string& path, const warnings::WarningsConfig& config, WarnRun& run,
                 std::string& error);

}  // namespace v2vouch::evaluation
