// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/campaign_jobs.h"

#include <cstddef>
#include <cstdio>
#include <set>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/io/lcm_url.h"
#include "sim/programs/shipped_files.h"

namespace v2vouch::campaign {
namespace {

bool ReadShard(const std::string& text, std::size_t& i, std::size_t& n) {
  char rest = 0;
  return std::sscanf(text.c_str(), "%zu/%zu%c", &i, &n, &rest) == 2 && i >= 1 && i <= n;
}

// No overlay suits any of the scenarios, or none was asked for.
std::string WhyNothing(const Plan& plan) {
  if (plan.overlays.empty()) {
    return "nothing to run: no attack, no honest condition, and --no-plain leaves out the rest";
  }
  std::string suits;
  for (const Overlay& overlay : plan.overlays) {
    suits += "; " + overlay.name() + " is for";
    for (const std::string& name : overlay.suits) suits += " " + name;
  }
  std::vector<std::string> scenarios = plan.scenarios;
  return "nothing to run: nothing asked for suits " + v2vouch::Listed(scenarios) + suits;
}

}  // namespace

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("--attacks", options.attacks,
                 "Ids (A5), variants (A5/lateral_8m), YAML files, all or none; comma-separated")
      ->capture_default_str();
  app.add_option("--honest", options.honest, "Honest conditions, likewise")->capture_default_str();
  app.add_option("--scenarios", options.scenarios, "Shipped names or YAML files")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--densities", options.densities,
                 "Vehicles of traffic (traffic.vehicles); 0 = as the scenario says")
      ->delimiter(',')
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  app.add_option("--seeds", options.seeds, "Seeds per combination")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed)->capture_default_str();
  app.add_option("--jobs", options.jobs, "Runs at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--shard", options.shard, "I/N: every N-th run from the I-th on");
  auto* out = app.add_option("--out", options.out, "Folder of the campaign");
  app.add_option("--merge", options.merge, "Report the runs of these folders; runs nothing")
      ->excludes(out);
  app.add_option("--config", options.config, "Vehicle description of the daemon")
      ->check(CLI::ExistingFile);
  app.add_flag("--field", options.field,
               "Also the paper's method and message-only checks, on the same runs");
  app.add_flag("--ghosts-only", options.ghosts_only,
               "Short form: --attacks A1,A2,A3,A4 --honest none --no-plain");
  app.add_flag("--no-plain", options.no_plain,
               "Leave out the runs without attack (LOCAL is then not compared)");
  app.add_flag(
      "--no-warnings", options.no_warnings,
      "Leave out what warnings three consumers would give, which takes a third of the time");
  app.add_flag("--gates", options.gates, "Exit code 1 when a target is missed or not measured");
  app.add_flag("--keep", options.keep, "Keep the log files, in OUT/tmp");
  app.add_option("--report", options.report, "Folder for index.html (made if absent)");
  app.add_flag("--json", options.as_json, "Figures as JSON on standard output");
  app.add_option("-l,--lcm-url", options.lcm_url, "Accepted for uniformity; nothing goes over LCM")
      ->check(v2vouch::CheckLcmUrl);
}

std::vector<Job> PlannedJobs(const Options& options, std::vector<std::string>& problems) {
  std::string problem;
  const auto files = v2vouch::sim::ShippedOverlays(problem);
  if (!problem.empty()) problems.push_back(problem);
  const auto catalogue = ReadCatalogue(files);
  Plan plan;
  plan.overlays = Select(options.attacks, Kind::kAttack, catalogue, problems);
  const auto honest = Select(options.honest, Kind::kHonest, catalogue, problems);
  plan.overlays.insert(plan.overlays.end(), honest.begin(), honest.end());
  plan.scenarios = options.scenarios;
  plan.densities = options.densities;
  plan.first_seed = options.first_seed;
  plan.seeds = options.seeds;
  plan.with_plain = !options.no_plain;
  for (const std::string& scenario : plan.scenarios) {
    std::string unknown;
    v2vouch::sim::FindScenario(scenario, unknown);
    if (!unknown.empty()) problems.push_back(unknown.substr(0, unknown.size() - 1));
  }
  auto jobs = Jobs(plan);
  std::set<std::string> keys;
  for (const Job& job : jobs) {
    if (!keys.insert(job.key()).second) {
      problems.push_back("two runs would be called " + job.key() + ": rename one of the files");
      break;
    }
  }
  if (jobs.empty() && problems.empty()) problems.push_back(WhyNothing(plan));
  std::size_t i = 1, n = 1;
  if (!options.shard.empty() && !ReadShard(options.shard, i, n)) {
    problems.push_back("--shard " + options.shard + ": must be I/N, 1 <= I <= N");
    return {};
  }
  return Shard(jobs, i, n);
}

}  // namespace v2vouch::campaign
