// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/campaign/runner.h"

namespace v2vouch::campaign {

/// What v2vouch-campaign is asked for.
struct Options {
  std::string attacks = "all", honest = "none", shard;
  std::vector<std::string> scenarios = {"campaign_urban", "campaign_highway"};
  std::vector<int> densities = {0};
  int seeds = 1, jobs = 1;
  std::uint64_t first_seed = 1;
  std::string out, config, report, lcm_url;
  std::vector<std::string> merge;
  bool as_json = false, field = false, keep = false, ghosts_only = false, no_plain = false;
  bool gates = false, no_warnings = false;
};

void AddOptions(CLI::App& app, Options& options);

/// The jobs asked for. Empty with `problems` set where something is wrong.
std::vector<Job> PlannedJobs(const Options& options, std::vector<std::string>& problems);

}  // namespace v2vouch::campaign
