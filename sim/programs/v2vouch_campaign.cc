// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "daemon/rim/program/shipped_folder.h"
#include "sim/campaign/report.h"
#include "sim/campaign/runner.h"
#include "sim/campaign/summary.h"
#include "sim/campaign/targets.h"
#include "sim/programs/campaign_jobs.h"

namespace {

using namespace v2vouch::campaign;
namespace fs = std::filesystem;

using v2vouch::kExitFailed;
using v2vouch::kExitGood;
using v2vouch::kExitUsage;
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
  settings.with_warnings = !options.no_warnings;
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

/// What every run needs: the other programs, and folders for what comes out.
void Prepare(const fs::path& out, const RunnerSettings& settings,
             std::vector<std::string>& problems) {
  for (const std::string& name : MissingPrograms(settings)) {
    problems.push_back(name + ": not in " + settings.programs.string() +
                       ", where every run would start it: keep the programs together");
  }
  if (!problems.empty()) return;
  std::error_code error;
  for (const fs::path& folder : {out / "runs", settings.scratch}) {
    if (!error) fs::create_directories(folder, error);
  }
  if (error) problems.push_back(out.string() + ": " + error.message());
}

/// @return exit code, or -1 to go on and report.
int RunCampaign(const Options& options) {
  std::vector<std::string> problems;
  const auto jobs = PlannedJobs(options, problems);
  const fs::path out = fs::absolute(options.out);
  RunnerSettings settings = SettingsOf(options, out);
  Prepare(out, settings, problems);
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
  if (!problems.empty()) return kExitUsage;

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
  std::error_code ignored;
  if (!options.keep && settings.scratch == out / "tmp") fs::remove(settings.scratch, ignored);
  if (stop_asked != 0) {
    Complain("stopped; what is done is kept, the same call goes on from there");
    return kExitFailed;
  }
  if (tally.failed > 0) {
    Complain(std::to_string(tally.failed) + " of " +
             std::to_string(tally.total - tally.there_before) + " runs failed");
  }
  return tally.failed > 0 ? kExitFailed : kExitGood;
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
    return kExitFailed;
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
      return kExitFailed;
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
  return is_good ? kExitGood : kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-campaign");
  CLI::App app(
      "Tries attacks and honest conditions over scenarios, densities and seeds, and scores "
      "how the daemon fares.");
  app.footer(kExamples);
  Options options;
  AddOptions(app, options);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-campaign", argc, argv)) return *code;
  if (options.out.empty() == options.merge.empty()) {
    Complain("give --out DIR (or --merge DIR...)");
    return kExitUsage;
  }
  if (options.ghosts_only) {
    options.attacks = "A1,A2,A3,A4";
    options.honest = "none";
    options.no_plain = true;
  }
  const int ran = options.out.empty() ? kExitGood : RunCampaign(options);
  if (ran == kNothingToDo) return kExitGood;
  if (ran == kExitUsage || stop_asked != 0) return ran;
  const int reported = Report(options);
  return std::max(ran, reported);
}
