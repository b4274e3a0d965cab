// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sim/campaign/summary.h"

namespace v2vouch::campaign {

/// The figures of a campaign as one self-contained HTML page: targets, one section per family of
/// attacks with its plots, the honest, the field. No script, no outside file, no date: the same
/// runs give the same bytes.
std::string ReportHtml(const Summary& summary);

/// Writes it to `folder`/index.html, making the folder.
/// @return the file's path, or empty with `problem` set.
std::filesystem::path WriteReport(const std::filesystem::path& folder, const Summary& summary,
                                  std::string& problem);

}  // namespace v2vouch::campaign
