// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/campaign/summary.h"

namespace v2vouch::campaign {

/// Plots of a family's attacks, as SVG; empty where there is nothing to show. `groups` are single
/// variants. `id` is unique in the page.

/// F1 of each attack as bars with their 95 % interval: ours, message-only checks where they ran,
/// and the published landmark.
std::string F1Bars(const std::vector<const Group*>& groups);

/// Largest exposure over all runs against the time since the attack began.
std::string ExposureOverTime(const std::vector<const Group*>& groups, const std::string& id);

/// Share of attackers met against the time since their first false message in view.
std::string MetOverTime(const std::vector<const Group*>& groups, const std::string& id);

/// Share of each attack's runs in which a lie causes an URGENT, as bars: V2V taken for true and
/// ours.
std::string LieBars(const std::vector<const Group*>& groups);

/// Slow drifts: median time until met, and largest exposure, against the rate; from the variants'
/// names ("lateral_0.5mps").
std::string DriftPlots(const std::vector<const Group*>& groups, const std::string& id);

}  // namespace v2vouch::campaign
