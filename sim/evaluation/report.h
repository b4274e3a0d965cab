// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/evaluation/evaluation.h"

namespace v2vouch::evaluation {

/// The report as one self-contained HTML page: no script, no outside file, no date; the same run
/// gives the same bytes. `paper` is the same run with the paper's association, or null.
std::string ReportHtml(const Evaluation& evaluation, const Evaluation* paper);

/// Writes ReportHtml() to `folder`/index.html, making the folder.
/// @return the file's path, or empty with `error` set.
std::string WriteReport(const std::string& folder, const Evaluation& evaluation,
                        const Evaluation* paper, std::string& error);

}  // namespace v2vouch::evaluation
