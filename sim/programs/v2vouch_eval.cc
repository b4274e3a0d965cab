// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/annotation/annotate_log.h"
#include "sim/behaviour/evaluation.h"
#include "sim/report/log_report.h"
#include "sim/report/report.h"
#include "sim/report/scene_clip.h"
#include "sim/report/scorecard_text.h"
#include "sim/run_log/why_not_judged.h"
#include "sim/spoofing/spoof_json.h"
#include "sim/warnings/judge_warnings.h"

namespace {

constexpr const char* kExamples =
    "Examples:\n"
    "  v2vouch-eval OUT.lcm                        table of all figures and gates\n"
    "  v2vouch-eval OUT.lcm --json --cutoff 30     the same for programs\n"
    "  v2vouch-eval OUT.lcm --report report/       report/index.html, one file\n"
    "  v2vouch-eval OUT.lcm --paper OUT_PAPER.lcm --report report/\n"
    "  v2vouch-eval OUT.lcm --spoof                how lies fared, and the honest; wants "
    "TRUTH_BSM\n"
    "                                              and `v2v.message_verdicts: true` in the replay\n"
    "  v2vouch-eval OUT.lcm --scorecard --json     errors by kind, lead vehicle, first listing; "
    "quick\n"
    "  v2vouch-eval OUT.lcm --warnings             v2vouch-warn's engine on V2V alone, LOCAL, "
    "both\n"
    "                                              lists and truth, compared\n"
    "  v2vouch-eval OUT.lcm --spoof --warnings     both\n"
    "  v2vouch-eval drive.lcm --summary            a real drive: counts, no truth needed\n"
    "  v2vouch-eval drive.lcm --report report/     a real drive: what was held when, trust, rates\n"
    "\n"
    "Exit codes: 0 good; 1 the log cannot be read or judged (no TRUTH and no --report, no lists, "
    "no overlap, a "
    "step of\n"
    "time), or with --gates a gate is missed; 2 usage.";

int Complain(const std::string& what) {
  std::fprintf(stderr, "v2vouch-eval: %s\n", what.c_str());
  return v2vouch::kExitFailed;
}

/// Shows the share done on a terminal; says nothing elsewhere.
std::function<void(double)> Progress(const char* what) {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [what](double share) {
    std::fprintf(stderr, "\r%s %3.0f %%%s", what, 100.0 * share, share >= 1.0 ? "\n" : "");
  };
}

bool Load(const std::string& path, v2vouch::evaluation::RunLog& log,
          v2vouch::evaluation::ReadScope scope = v2vouch::evaluation::ReadScope::kAll) {
  std::string error;
  if (v2vouch::evaluation::ReadRunLog(path, Progress("reading"), log, error, scope)) {
    v2vouch::NoteDamage("v2vouch-eval", path, log.damaged);
    return true;
  }
  std::fprintf(stderr, "v2vouch-eval: %s\n", error.c_str());
  return false;
}

// A few frames of the first camera, where the log has its pictures.
std::vector<v2vouch::evaluation::ReportPicture> PicturesOf(const std::string& log) {
  constexpr int kPictures = 6;
  v2vouch::sim::AnnotationRequest request;
  request.log = log;
  request.at_most = kPictures;
  v2vouch::sim::AnnotationResult result;
  std::vector<v2vouch::evaluation::ReportPicture> pictures;
  std::string ignored;  // A log without camera has no such pictures; nothing is wrong with that.
  const auto take = [&](v2vouch::Timestamp, const cv::Mat& picture) {
    if (!result.has_images) return false;
    v2vouch::evaluation::ReportPicture taken;
    taken.caption = "frame " + std::to_string(result.pictures) + " of the report";
    cv::imencode(".jpg", picture, taken.jpeg);
    pictures.push_back(std::move(taken));
    return true;
  };
  v2vouch::sim::AnnotateLog(request, take, result, ignored);
  return pictures;
}

std::optional<v2vouch::evaluation::WarnScore> WarningsOf(const std::string& path,
                                                         v2vouch::evaluation::WarnRun& run) {
  using namespace v2vouch::evaluation;
  std::string error;
  if (RunWarnings(path, {}, run, error)) return JudgeWarnings(run);
  Complain(path + ": " + error);
  return std::nullopt;
}

// With both asked for, one JSON object: that of the lies, with `warnings` in it.
int PrintLies(const v2vouch::evaluation::SpoofRun& run,
              const v2vouch::evaluation::WarnScore* warnings, bool as_json) {
  using namespace v2vouch::evaluation;
  std::string text = as_json ? SpoofJson(run) : SpoofTable(run);
  if (warnings != nullptr && as_json) {
    std::string inner = WarnScoreJson(*warnings);
    while (!inner.empty() && inner.back() == '\n') inner.pop_back();
    text = text.substr(0, text.rfind('}')) + ",\"warnings\":" + inner + "}\n";
  } else if (warnings != nullptr) {
    text += "\n" + WarnScoreTable(*warnings);
  }
  std::fputs(text.c_str(), stdout);
  return v2vouch::kExitGood;
}

int JudgeLies(const std::string& path, bool with_message_checks, bool with_warnings, bool as_json) {
  using namespace v2vouch::evaluation;
  RunLog log;
  if (!Load(path, log, ReadScope::kSpoof)) return v2vouch::kExitFailed;
  if (const std::string why = WhyNotJudged(log); !log.truth.empty() && !why.empty()) {
    return Complain(path + ": " + why);
  }
  const char* missing = log.truth.empty()        ? "TRUTH"
                        : log.bsm_truths.empty() ? "TRUTH_BSM"
                        : log.bsm_verdicts.empty()
                            ? "BSM_VERDICT (set `v2v.message_verdicts: true`)"
                            : nullptr;
  if (missing != nullptr) {
    std::fprintf(stderr, "v2vouch-eval: %s holds no %s, so spoofing cannot be judged.\n",
                 path.c_str(), missing);
    return v2vouch::kExitFailed;
  }
  const SpoofRun run = JudgeSpoof(log, with_message_checks);
  if (!with_warnings) return PrintLies(run, nullptr, as_json);
  WarnRun warn_run;
  const auto warnings = WarningsOf(path, warn_run);
  return warnings ? PrintLies(run, &*warnings, as_json) : v2vouch::kExitFailed;
}

// What became of each BSM, where the log says so; null where it cannot be judged.
std::unique_ptr<v2vouch::evaluation::LiarFacts> LiarsOf(const std::string& path) {
  using namespace v2vouch::evaluation;
  auto facts = std::make_unique<LiarFacts>();
  if (!Load(path, facts->log, ReadScope::kSpoof)) return nullptr;
  if (facts->log.bsm_truths.empty() || facts->log.bsm_verdicts.empty()) return nullptr;
  facts->judged = JudgeSpoof(facts->log, false);
  return facts;
}

int PutReport(const std::string& folder, const std::string& html, const std::string& story) {
  std::string error;
  const std::string file = v2vouch::evaluation::WritePage(folder, html, error);
  if (file.empty()) return Complain(error);
  std::fprintf(stderr, "%s\nreport: %s\n", story.c_str(), file.c_str());
  return v2vouch::kExitGood;
}

int PrintWarnings(const std::string& path, bool as_json) {
  using namespace v2vouch::evaluation;
  WarnRun run;
  const auto score = WarningsOf(path, run);
  if (!score) return v2vouch::kExitFailed;
  v2vouch::NoteDamage("v2vouch-eval", path, run.damaged);
  std::fputs((as_json ? WarnScoreJson(*score) : WarnScoreTable(*score)).c_str(), stdout);
  return v2vouch::kExitGood;
}

int PrintSummary(const std::string& path, const v2vouch::evaluation::RunLog& log, bool as_json) {
  using namespace v2vouch::evaluation;
  std::fputs((as_json ? ListSummaryJson(log) : ListSummary(log)).c_str(), stdout);
  const bool has_lists =
      std::ranges::any_of(log.lists, [](const auto& lists) { return !lists.empty(); });
  if (has_lists) return v2vouch::kExitGood;
  if (!log.other_types.empty()) return Complain(path + ": " + OtherTypesText(log.other_types));
  return Complain(path + ": holds no track lists; `v2vouch-replay LOG --out OUT` makes them");
}

int ReportWithoutTruth(const std::string& path, const v2vouch::evaluation::RunLog& log,
                       const std::string& folder, bool as_json) {
  using namespace v2vouch::evaluation;
  LogFacts facts;
  std::string error;
  if (!ReadLogFacts(path, facts, error)) return Complain(error);
  const int code =
      PutReport(folder, LogReportHtml(log, facts, PicturesOf(path), SceneClip(path, {})),
                StoryWithoutTruth(log));
  return code != v2vouch::kExitGood ? code : PrintSummary(path, log, as_json);
}

int PrintScorecards(const v2vouch::evaluation::RunLog& log,
                    const v2vouch::evaluation::ScoringSettings& settings, bool as_json) {
  using namespace v2vouch::evaluation;
  ScorecardSettings card;
  card.cutoff_m = settings.cutoff_m;
  const Scorecards cards = JudgeScorecards(log, card);
  std::fputs((as_json ? ScorecardFileJson(log, cards) : ScorecardTable(cards)).c_str(), stdout);
  return v2vouch::kExitGood;
}

struct Options {
  std::string log_path, paper_path, report_folder, lcm_url;
  v2vouch::evaluation::ScoringSettings settings;
  std::vector<std::string> joined;
  bool scorecard = false;
  bool as_json = false, summary = false, use_gates = false, spoof = false, message_checks = false;
  bool warnings = false;
};

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("LOG", options.log_path, "Recorded run: outputs of the daemon or v2vouch-replay")
      ->required();
  app.add_option("--paper", options.paper_path,
                 "The same run with `association: paper`, shown beside");
  app.add_option("--report", options.report_folder, "Folder for index.html (made if absent)");
  app.add_option("--cutoff", options.settings.cutoff_m, "GOSPA cutoff c [m]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--switching-penalty", options.settings.switching_m,
                 "Switching penalty [m]; default half the cutoff")
      ->check(CLI::Range(0.0, 1000.0));
  app.add_flag("--json", options.as_json, "Figures as JSON on standard output");
  app.add_flag("--summary", options.summary,
               "Counts and lengths of the lists only; needs no truth");
  app.add_flag("--scorecard", options.scorecard,
               "The scorecards of LOCAL and PRIORITY only: no bound, a tenth of the time");
  app.add_option(
      "--join", options.joined,
      "Further runs of the same drive whose LOCAL tracks are added (the ladder's vehicles "
      "alone)");
  app.add_flag("--gates", options.use_gates, "Exit code 1 when a gate is missed");
  app.add_flag("--warnings", options.warnings,
               "Warnings of three consumers against those on truth; contacts, needless braking");
  auto* of_spoof =
      app.add_flag("--spoof", options.spoof, "Spoof resistance instead of tracking accuracy");
  app.add_flag("--message-checks", options.message_checks,
               "With --spoof: message-only checks of the published kind on the same messages")
      ->needs(of_spoof);
  app.add_option("-l,--lcm-url", options.lcm_url, "Accepted for uniformity; logs need no network")
      ->check(v2vouch::CheckLcmUrl);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  v2vouch::GuardStandardStreams("v2vouch-eval");
  using namespace v2vouch::evaluation;
  CLI::App app(
      "Judges a recorded run against its truth: GOSPA with all parts, bound, gates, report.");
  app.footer(kExamples);
  Options options;
  AddOptions(app, options);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-eval", argc, argv)) return *code;

  const std::string& log_path = options.log_path;
  if (options.spoof) {
    return JudgeLies(log_path, options.message_checks, options.warnings, options.as_json);
  }
  if (options.warnings) return PrintWarnings(log_path, options.as_json);
  RunLog log;
  if (!Load(log_path, log)) return v2vouch::kExitFailed;
  for (std::size_t k = 0; k < options.joined.size(); ++k) {
    RunLog other;
    if (!Load(options.joined[k], other)) return v2vouch::kExitFailed;
    JoinLocal(other, static_cast<int>(k + 1), log);
  }
  if (options.summary) return PrintSummary(log_path, log, options.as_json);
  if (log.truth.empty() && !options.report_folder.empty()) {
    return ReportWithoutTruth(log_path, log, options.report_folder, options.as_json);
  }
  if (const std::string why = WhyNotJudged(log); !why.empty()) {
    return Complain(log_path + ": " + why);
  }
  if (options.scorecard) return PrintScorecards(log, options.settings, options.as_json);
  const auto evaluation = Evaluate(std::move(log), options.settings);
  std::unique_ptr<Evaluation> paper;
  if (!options.paper_path.empty()) {
    RunLog paper_log;
    if (!Load(options.paper_path, paper_log)) return v2vouch::kExitFailed;
    if (const std::string why = WhyNotJudged(paper_log); !why.empty()) {
      return Complain(options.paper_path + ": " + why);
    }
    paper = Evaluate(std::move(paper_log), options.settings);
  }
  if (!options.report_folder.empty()) {
    LogFacts facts;
    std::string error;
    if (!ReadLogFacts(log_path, facts, error)) return Complain(error);
    const auto liars = LiarsOf(log_path);
    const std::string html =
        ReportHtml(*evaluation, paper.get(), PicturesOf(log_path), liars.get(), &facts,
                   SceneClip(log_path, MomentWorthSeeing(*evaluation)));
    const int code = PutReport(options.report_folder, html, Story(*evaluation, liars.get()));
    if (code != v2vouch::kExitGood) return code;
  }
  const std::string figures =
      options.as_json ? ToJson(*evaluation, paper.get()) : ToTable(*evaluation, paper.get());
  std::fputs(figures.c_str(), stdout);
  if (options.use_gates) {
    for (const Gate& gate : evaluation->gates) {
      if (!gate.passes()) return v2vouch::kExitFailed;
    }
  }
  return v2vouch::kExitGood;
}
