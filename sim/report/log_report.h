// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/report/report.h"
#include "sim/run_log/log_facts.h"

namespace v2vouch::evaluation {

/// The report of a run without truth: what happened, what was held when, trust over time, sensor
/// rates, verdicts, refusals. One self-contained page as ReportHtml()'s.
std::string LogReportHtml(const RunLog& log, const LogFacts& facts,
                          const std::vector<ReportPicture>& pictures = {},
                          const std::string& clip = "");

/// Of it, for both reports: message rates over time, and the refusals as a table.
std::string RatesHtml(const LogFacts& facts);
std::string RefusalsHtml(const LogFacts& facts);

}  // namespace v2vouch::evaluation
