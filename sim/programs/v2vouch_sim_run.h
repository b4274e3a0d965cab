// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace v2vouch::sim {

struct RunOptions {
  std::string scenario;               ///< File.
  std::vector<std::string> overlays;  ///< Files laid over it, in order.
  std::uint64_t seed = 1;
  std::string out;                    ///< Log to write; empty with `live`.
  std::string vehicle_out;            ///< Configuration file to write for the daemon; empty = none.
  bool live = false;                  ///< Over LCM in real time.
  std::string lcm_url;                ///< Empty: LCM_DEFAULT_URL, then LCM's own default.
  double duration_s = 0.0;            ///< 0 = the scenario's own.
  std::vector<std::string> settings;  ///< KEY=VALUE over all files, dots between levels.
  bool json = false;
};

/// Simulates and writes or sends. SIGINT and SIGTERM end it early and cleanly.
/// @return the program's exit code.
int Run(const RunOptions& options);

}  // namespace v2vouch::sim
