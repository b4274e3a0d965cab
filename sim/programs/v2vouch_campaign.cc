// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "daemon/rim/program/shipped_folder.h"
#include "sim/campaign/report.h"
#include "sim/campaign/runner.h"
#include "sim/campaign/summary.h"
#include "sim/campaign/targets.h"
#include "sim/programs/shipped_files.h"

namespace {

using namespace v2vouch::campaign;
namespace fs = std::filesystem;

constexpr int kGood = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kNothingToDo = -1;

constexpr const char* kExamples =
    "Examples:\n"
    "  v2vouch-campaign --attacks A1,A5 --honest H1 --seeds 5 --jobs 2 --out study/\n"
    "  v2vouch-campaign --attacks A5/lateral_8m,my_attack.yaml --honest none --seeds 5 --out "
    "study/\n"
    "  v2vouch-campaign --attacks all --honest all --densities 5,20,60 --seeds 20 --first-seed 401 "
    "\\\n"
    "      --jobs 8 --out study/ --json > study.json\n"
    "  v2vouch-campaign ... --shard 2/4 --out study/      a quarter of the same runs\n"
    "  v2vouch-campaign --merge host1/ host2/ --json      figures of what several hosts did\n"
    "  v2vouch-campaign --merge study/ --report page/     page/index.html, with plots\n"
    "  v2vouch-campaign --ghosts-only --seeds 2 --out g/  is a liar ever published?\n"
    "\n"
    "The same call again takes up where it was stopped: each run leaves one small file under\n"
    "OUT/runs. Call with another --config, another daemon or other attacks: another --out.\n"
    "docs/how-to/run-a-campaign.md tells more, GNU parallel and Slurm included.\n"
    "\n"
    "Exit codes: 0 good; 1 a run failed or was stopped, with --gates a target is missed, with\n"
    "--ghosts-only an attacker was published as a ghost; 2 usage.";

struct Options {
  std::string attacks = "all", honest = "none", shard;
  std::vector<std::string> scenarios = {"campaign_urban", "campaign_highway"};
  std::vector<int> densities = {0};
  int seeds = 1, jobs = 1;
  std::uint64_t first_seed = 1;
  std::string out, config, report, lcm_url;
  std::vector<std::string> merge;
  bool as_json = false, field = false, keep = false, ghosts_only = false, no_plain = false;
  bool gates = false;
};

volatile std::sig_atomic_t stop_asked = 0;

void Complain(const std::string& what) {
  std::fprintf(stderr, "v2vouch-campaign: %s\n", what.c_str());
}

std::string LeftText(double seconds) {
  const auto s = static_cast<long>(seconds);
  char text[32];
  std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", s / 3600, s / 60 % 60, s % 60);
  return text;
}

/// On a terminal one line that is overwritten; elsewhere one line per minute.
class Progress {
 public:
  void Show(const Tally& tally) {
    const double now_s = Elapsed();
    const bool is_over = tally.left() == 0;
    if (tally.total == tally.there_before) return;
    if (!is_terminal_ && (now_s < next_line_s_ && !is_over)) return;
    next_line_s_ = now_s + 60.0;
    const auto finished = static_cast<double>(tally.done + tally.failed);
    const std::string left =
        finished > 0.0 ? LeftText(now_s / finished * static_cast<double>(tally.left())) : "?";
    std::fprintf(stderr, "%s%zu of %zu runs, %zu failed, %s left%s", is_terminal_ ? "\r" : "",
                 tally.there_before + tally.done, tally.total, tally.failed, left.c_str(),
                 is_terminal_ && !is_over ? "   " : "\n");
  }

 private:
  [[nodiscard]] double Elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  bool is_terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double next_line_s_ = 60.0;
};

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

/// The jobs asked for. Empty with `problems` set where something is wrong.
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

/// The daemon's configuration a campaign runs with stays that of its folder.
bool SettleConfig(const fs::path& from, const fs::path& kept, std::string& problem) {
  // Shards may begin at the same moment: each writes its own, then all look at what stands.
  const fs::path own = kept.string() + "." + std::to_string(getpid()) + ".part";
  if (!WriteConfig(from, own, problem)) return false;
  const auto content = [](const fs::path& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  std::error_code error;
  const bool is_new = !fs::exists(kept);
  const bool is_same = is_new || content(own) == content(kept);
  if (is_new) {
    fs::rename(own, kept, error);
  } else {
    fs::remove(own, error);
  }
  if (!is_same) problem = kept.string() + ": the runs there were made with another configuration";
  return is_same;
}

fs::path OwnFolder() {
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path(".") : own.parent_path();
}

RunnerSettings SettingsOf(const Options& options, const fs::path& out) {
  RunnerSettings settings;
  settings.programs = OwnFolder();
  settings.folder = out;
  const char* scratch = std::getenv("TMPDIR");
  settings.scratch = !options.keep && scratch != nullptr ? fs::path(scratch) : out / "tmp";
  settings.with_message_checks = options.field;
  settings.keeps_logs = options.keep;
  settings.at_a_time = options.jobs;
  return settings;
}

// Whether the daemon takes the configuration, or every single run would say it.
bool IsUsable(const std::string& config, const RunnerSettings& settings, Children& children) {
  const ChildResult check = children.Run(
      {(settings.programs / "v2vouchd").string(), "--config", config, "--print-config"},
      settings.scratch / ("check." + std::to_string(getpid())));
  if (!check.has_started || check.exit_code == 0) return true;
  std::fputs(check.err.c_str(), stderr);
  return false;
}

/// @return exit code, or -1 to go on and report.
int RunCampaign(const Options& options) {
  std::vector<std::string> problems;
  const auto jobs = PlannedJobs(options, problems);
  const fs::path out = fs::absolute(options.out);
  RunnerSettings settings = SettingsOf(options, out);
  std::error_code error;
  if (problems.empty()) {
    for (const fs::path& folder : {out / "runs", settings.scratch}) {
      if (!error) fs::create_directories(folder, error);
    }
    if (error) problems.push_back(options.out + ": " + error.message());
  }
  Children children;
  std::string problem;
  if (problems.empty() && !options.config.empty() &&
      !IsUsable(options.config, settings, children)) {
    problems.push_back(options.config + ": cannot be used");
  }
  if (problems.empty()) {
    settings.config = out / "vehicle.yaml";
    if (!SettleConfig(options.config, settings.config, problem)) problems.push_back(problem);
  }
  if (options.field && !v2vouch::WhyNotShipped("config").empty()) {
    problems.push_back(v2vouch::WhyNotShipped("config"));
  }
  if (problems.empty() && options.field) {
    settings.paper_config = out / "vehicle_paper.yaml";
    if (!SettleConfig(v2vouch::ShippedFolder("config") / "vehicle_paper.yaml",
                      settings.paper_config, problem)) {
      problems.push_back(problem);
    }
  }
  for (const std::string& each : problems) Complain(each);
  if (!problems.empty()) return kUsage;

  if (jobs.empty()) {
    Complain("--shard " + options.shard + " holds none of the runs: nothing to do here");
    return kNothingToDo;
  }
  Progress progress;
  std::signal(SIGINT, [](int) { stop_asked = 1; });
  std::signal(SIGTERM, [](int) { stop_asked = 1; });
  const Tally tally = RunAll(
      jobs, settings, children,
      [&](const Tally& now) {
        if (stop_asked != 0 && !children.is_stopped()) children.Stop();
        progress.Show(now);
      },
      Complain);
  if (!options.keep && settings.scratch == out / "tmp") fs::remove(settings.scratch, error);
  if (stop_asked != 0) {
    Complain("stopped; what is done is kept, the same call goes on from there");
    return kFailed;
  }
  if (tally.failed > 0) {
    Complain(std::to_string(tally.failed) + " of " +
             std::to_string(tally.total - tally.there_before) + " runs failed");
  }
  return tally.failed > 0 ? kFailed : kGood;
}

int Report(const Options& options) {
  std::vector<fs::path> folders(options.merge.begin(), options.merge.end());
  if (!options.out.empty()) folders.insert(folders.begin(), options.out);
  std::vector<std::string> problems;
  const auto records = ReadRecords(folders, problems);
  for (const std::string& problem : problems) Complain(problem);
  if (records.empty()) {
    std::string names;
    for (const fs::path& folder : folders) names += (names.empty() ? "" : ", ") + folder.string();
    Complain("no runs to report: " + names + " holds no runs/*.json of a campaign");
    return kFailed;
  }
  const Summary summary = Summarise(records);
  const std::string figures =
      options.as_json ? SummaryJson(summary) : SummaryTable(summary, options.field);
  std::fputs(figures.c_str(), stdout);
  if (!options.report.empty()) {
    std::string problem;
    const fs::path file = WriteReport(options.report, summary, problem);
    if (file.empty()) {
      Complain(problem);
      return kFailed;
    }
    std::fprintf(stderr, "report: %s\n", file.c_str());
  }
  bool is_good = problems.empty();
  if (options.ghosts_only) {
    for (const Group& group : summary.attacks) is_good &= group.attack.ghosts_of_attackers == 0;
  }
  if (options.gates) {
    for (const Target& target : JudgeTargets(summary)) is_good &= target.is_met();
  }
  return is_good ? kGood : kFailed;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-campaign");
  CLI::App app(
      "Tries attacks and honest conditions over scenarios, densities and seeds, and scores "
      "how the daemon fares.");
  app.footer(kExamples);
  Options options;
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
  app.add_flag("--gates", options.gates, "Exit code 1 when a target is missed or not measured");
  app.add_flag("--keep", options.keep, "Keep the log files, in OUT/tmp");
  app.add_option("--report", options.report, "Folder for index.html (made if absent)");
  app.add_flag("--json", options.as_json, "Figures as JSON on standard output");
  app.add_option("-l,--lcm-url", options.lcm_url, "Accepted for uniformity; nothing goes over LCM")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-campaign", argc, argv)) return *code;
  if (options.out.empty() == options.merge.empty()) {
    Complain("give --out DIR (or --merge DIR...)");
    return kUsage;
  }
  if (options.ghosts_only) {
    options.attacks = "A1,A2,A3,A4";
    options.honest = "none";
    options.no_plain = true;
  }
  const int ran = options.out.empty() ? kGood : RunCampaign(options);
  if (ran == kNothingToDo) return kGood;
  if (ran == kUsage || stop_asked != 0) return ran;
  const int reported = Report(options);
  return std::max(ran, reported);
}
