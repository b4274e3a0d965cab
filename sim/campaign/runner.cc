// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/runner.h"

#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "sim/spoofing/spoof_json.h"

namespace v2vouch::campaign {
namespace {

using Json = nlohmann::json;

/// One run's way through the three programs.
class Run {
 public:
  Run(const Job& job, const RunnerSettings& settings, Children& children)
      : job_(job), settings_(settings), children_(children) {
    // Shards may share the folder.
    stem_ = settings.scratch / (job.key() + "." + std::to_string(getpid()));
    log_ = stem_.string() + ".lcm";
    out_ = stem_.string() + ".out.lcm";
    paper_out_ = stem_.string() + ".paper.lcm";
  }
  ~Run() {
    if (settings_.keeps_logs) return;
    std::error_code ignored;
    for (const auto& file : {log_, out_, paper_out_}) std::filesystem::remove(file, ignored);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// @return nothing with `problem` set.
  std::optional<RunRecord> Do(std::string& problem) {
    RunRecord record;
    record.job = job_;
    if (!Child(Simulation(), problem)) return std::nullopt;
    const auto figures = Child(Replay(settings_.config, out_), problem);
    if (!figures || !TakeReplay(*figures, record, problem)) return std::nullopt;
    const auto text = Judged(out_, true, problem);
    if (!text || !TakeFigures(*text, record.ours, problem)) return std::nullopt;
    if (settings_.with_warnings && !TakeWarnings(*text, record, problem)) return std::nullopt;
    if (settings_.paper_config.empty()) return record;
    record.paper.emplace();
    if (!Child(Replay(settings_.paper_config, paper_out_), problem) ||
        !ScorePaper(*record.paper, problem)) {
      return std::nullopt;
    }
    return record;
  }

 private:
  [[nodiscard]] std::string Program(const char* name) const {
    return (settings_.programs / name).string();
  }

  [[nodiscard]] std::vector<std::string> Simulation() const {
    std::vector<std::string> command = {Program("v2vouch-sim"), "run", job_.scenario};
    if (!job_.overlay.file.empty()) command.insert(command.end(), {"--with", job_.overlay.file});
    if (job_.density > 0) {
      command.insert(command.end(), {"--set", "traffic.vehicles=" + std::to_string(job_.density)});
    }
    command.insert(command.end(), {"--seed", std::to_string(job_.seed), "--out", log_.string()});
    return command;
  }

  [[nodiscard]] std::vector<std::string> Replay(const std::filesystem::path& config,
                                                const std::filesystem::path& out) const {
    return {Program("v2vouch-replay"),
            log_.string(),
            "--config",
            config.string(),
            "--out",
            out.string(),
            "--json"};
  }

  // @return what it printed, or nothing with `problem` set.
  std::optional<std::string> Child(const std::vector<std::string>& command, std::string& problem) {
    ChildResult result = children_.Run(command, stem_);
    if (result.has_started && result.exit_code == 0) return std::move(result.out);
    problem = ShellText(command) + "\n" +
              (result.has_started ? "exit code " + std::to_string(result.exit_code) + ": " : "") +
              result.err;
    return std::nullopt;
  }

  bool TakeReplay(const std::string& text, RunRecord& record, std::string& problem) const {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("digest_local") || !json.contains("step_us")) {
      problem = "v2vouch-replay printed no figures: " + text.substr(0, 200);
      return false;
    }
    record.local_digest = json["digest_local"].get<std::string>();
    record.step_p99_us = json["step_us"].value("p99", 0.0);
    record.step_max_us = json["step_us"].value("max", 0.0);
    return true;
  }

  // What v2vouch-eval prints, or nothing with `problem` set.
  std::optional<std::string> Judged(const std::filesystem::path& log, bool is_ours,
                                    std::string& problem) {
    std::vector<std::string> command = {Program("v2vouch-eval"), log.string(), "--spoof", "--json"};
    if (is_ours && settings_.with_message_checks) command.emplace_back("--message-checks");
    if (is_ours && settings_.with_warnings) command.emplace_back("--warnings");
    return Child(command, problem);
  }

  static bool TakeFigures(const std::string& text, evaluation::SpoofRun& run,
                          std::string& problem) {
    if (evaluation::ReadSpoofJson(text, run)) return true;
    problem = "v2vouch-eval printed no figures: " + text.substr(0, 200);
    return false;
  }

  static bool TakeWarnings(const std::string& text, RunRecord& record, std::string& problem) {
    const Json json = Json::parse(text, nullptr, false);
    record.warnings.emplace();
    if (json.is_object() && json.contains("warnings")) {
      record.warnings_json = json["warnings"].dump();
      if (evaluation::ReadWarnTally(record.warnings_json, *record.warnings)) return true;
    }
    problem = "v2vouch-eval printed no figures of warnings: " + text.substr(0, 200);
    return false;
  }

  bool ScorePaper(evaluation::SpoofRun& run, std::string& problem) {
    const auto text = Judged(paper_out_, false, problem);
    return text && TakeFigures(*text, run, problem);
  }

  const Job& job_;
  const RunnerSettings& settings_;
  Children& children_;
  std::filesystem::path stem_, log_, out_, paper_out_;
};

bool IsThere(const Job& job, const RunnerSettings& settings) {
  const auto record = ReadRecord(RecordPath(settings.folder, job));
  if (!record) return false;
  if (settings.with_message_checks && !record->ours.checks_by_message) return false;
  if (settings.with_warnings && !record->warnings) return false;
  return settings.paper_config.empty() || record->paper.has_value();
}

}  // namespace

std::vector<std::string> MissingPrograms(const RunnerSettings& settings) {
  std::vector<std::string> missing;
  for (const char* const name : {"v2vouch-sim", "v2vouch-replay", "v2vouch-eval"}) {
    if (access((settings.programs / name).c_str(), X_OK) != 0) missing.emplace_back(name);
  }
  return missing;
}

Tally RunAll(const std::vector<Job>& jobs, const RunnerSettings& settings, Children& children,
             const std::function<void(const Tally&)>& tick,
             const std::function<void(const std::string&)>& tell) {
  Tally tally;
  tally.total = jobs.size();
  std::vector<const Job*> waiting;
  for (const Job& job : jobs) {
    if (IsThere(job, settings)) {
      ++tally.there_before;
    } else {
      waiting.push_back(&job);
    }
  }
  std::mutex mutex;  // Guards the tally, the problems and the number of workers.
  std::condition_variable changed;
  std::vector<std::string> problems;
  std::atomic<std::size_t> next = 0;
  std::size_t workers_left = static_cast<std::size_t>(std::max(1, settings.at_a_time));
  const auto work = [&] {
    for (std::size_t k = next++; k < waiting.size() && !children.is_stopped(); k = next++) {
      std::string problem;
      auto record = Run(*waiting[k], settings, children).Do(problem);
      if (record && !WriteRecord(settings.folder, *record, problem)) record.reset();
      if (!record && children.is_stopped()) break;
      const std::lock_guard lock(mutex);
      ++(record ? tally.done : tally.failed);
      if (!record) problems.push_back(waiting[k]->key() + " failed: " + problem);
    }
    const std::lock_guard lock(mutex);
    --workers_left;
    changed.notify_one();
  };
  std::vector<std::jthread> workers;
  const std::size_t count = workers_left;
  for (std::size_t i = 0; i < count; ++i) workers.emplace_back(work);
  std::unique_lock lock(mutex);
  for (;;) {
    changed.wait_for(lock, std::chrono::milliseconds(200), [&] { return workers_left == 0; });
    const std::vector<std::string> told = std::exchange(problems, {});
    const Tally now = tally;
    const bool is_over = workers_left == 0;
    lock.unlock();
    for (const std::string& problem : told) tell(problem);
    tick(now);
    lock.lock();
    if (is_over) return tally;
  }
}

bool WriteConfig(const std::filesystem::path& from, const std::filesystem::path& to,
                 std::string& problem) {
  try {
    YAML::Node root = from.empty() ? YAML::Node() : YAML::LoadFile(from.string());
    root["v2v"]["message_verdicts"] = true;
    // What the file names beside it is not beside its copy.
    const std::filesystem::path folder =
        from.empty() ? from : std::filesystem::absolute(from).parent_path();
    const auto settle = [&](YAML::Node section, const char* key) {
      if (!section.IsMap() || !section[key] || !section[key].IsScalar()) return;
      const std::string file = section[key].as<std::string>();
      if (!file.empty()) section[key] = (folder / file).lexically_normal().string();
    };
    settle(root, "calibration");
    if (root["detector"]) {
      settle(root["detector"], "model");
      settle(root["detector"], "network");
    }
    std::ofstream file(to);
    file << root << "\n";
    file.close();
    if (file) return true;
    problem = "cannot write " + to.string();
  } catch (const YAML::Exception& fault) {
    problem = from.string() + ": " + fault.what();
  }
  return false;
}

}  // namespace v2vouch::campaign
