// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/behaviour/evaluation.h"
#include "sim/report/story.h"
#include "sim/run_log/log_facts.h"

namespace v2vouch::evaluation {

/// A camera picture with what was seen and tracked drawn in, for the report.
struct ReportPicture {
  std::string caption;
  std::vector<std::uint8_t> jpeg;
};

/// The report as one self-contained HTML page: no outside file, no date; the same run gives the
/// same bytes. `paper` is the same run with the paper's association, `liars` what is known of false
/// BSMs, `facts` the log's own figures; each may be null. `pictures` stand inside the page, and so
/// does `clip` (scene_clip.h; the one part with scripts).
std::string ReportHtml(const Evaluation& evaluation, const Evaluation* paper,
                       const std::vector<ReportPicture>& pictures = {},
                       const LiarFacts* liars = nullptr, const LogFacts* facts = nullptr,
                       const std::string& clip = "");

/// The middle one of the pictures' moments: where the clip begins to be worth a look.
std::optional<Timestamp> MomentWorthSeeing(const Evaluation& evaluation);

/// Writes a page to `folder`/index.html, making the folder.
/// @return the file's path, or empty with `error` set.
std::string WritePage(const std::string& folder, const std::string& html, std::string& error);

}  // namespace v2vouch::evaluation
