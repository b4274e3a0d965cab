// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "sim/report/report.h"

namespace v2vouch::evaluation {

inline constexpr char kCameraNote[] =
    "White: what the network or the smart camera saw. Green: LOCAL, magenta: PRIORITY, as boxes "
    "standing on a flat road.";

inline constexpr char kClipNote[] =
    "Blue: LOCAL. Green ring: PRIORITY; orange and dashed: hidden, carried by V2V, the arc is the "
    "budget "
    "that is left. Arrows: what senders claim, with a cross where it is not believed. Thin boxes: "
    "truth, "
    "where there is one. Hover, click, drag; space plays, wheel after a click zooms, 1 to 8 are "
    "layers.";

/// Everything up to the first card; `sub` stands below the title.
std::string PageHead(const std::string& title, const std::string& sub);
std::string PageFoot();
/// One section; `text` may hold HTML.
std::string Card(const std::string& title, const std::string& text, const std::string& body);
/// The story as a paragraph; no line ends between a figure and its unit.
std::string StoryHtml(const std::string& story);
std::string PicturesHtml(const std::vector<ReportPicture>& pictures);

}  // namespace v2vouch::evaluation
