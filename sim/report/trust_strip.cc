// SPDX-License-Identifier: Apache-2.0
#include "sim/report/trust_strip.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>

#include "sim/plot/svg.h"
#include "sim/report/story.h"

namespace v2vouch::evaluation {
namespace {

constexpr double kWidth = 1060.0, kLeft = 132.0, kRight = 14.0, kTop = 30.0, kRow = 20.0;
constexpr double kGap_s = 1.0;  // Lists further apart do not join.

struct Shade {
  const char* label;
  const char* fill;
};
// By track_t's TRUST_ constants from TRUST_UNKNOWN = 1 on; Okabe and Ito's colours.
constexpr std::array<Shade, 6> kTrust = {{{"unknown", "#b8bec6"},
                                          {"candidate", "#e8d44d"},
                                          {"validated", "#009e73"},
                                          {"bridged", "#56b4e9"},
                                          {"suspect", "#e69f00"},
                                          {"revoked", "#c0392b"}}};

struct Stretch {
  double from_s, to_s;
  std::size_t shade;
};
struct StripRow {
  std::string name;
  std::vector<Stretch> stretches;
  std::vector<double> marks_s;
  [[nodiscard]] double length_s() const {
    double sum = 0.0;
    for (const Stretch& stretch : stretches) sum += stretch.to_s - stretch.from_s;
    return sum;
  }
};

void Add(StripRow& row, double t_s, std::size_t shade) {
  if (!row.stretches.empty()) {
    Stretch& last = row.stretches.back();
    if (t_s - last.to_s < kGap_s) {
      last.to_s = t_s;
      if (last.shade == shade) return;
    }
  }
  row.stretches.push_back({t_s, t_s, shade});
}

std::string Draw(const std::vector<StripRow>& rows, std::span<const Shade> shades, double end_s,
                 const std::string& left_out) {
  if (rows.empty()) return "<p>none</p>\n";
  const double bottom = kTop + kRow * static_cast<double>(rows.size());
  Svg svg(kWidth, bottom + 36.0);
  const auto x = [&](double t_s) {
    return kLeft + std::clamp(t_s / end_s, 0.0, 1.0) * (kWidth - kLeft - kRight);
  };
  double legend_x = kLeft;
  for (const Shade& shade : shades) {
    svg.Rect(legend_x, 9.0, 18.0, 9.0, std::string("fill=\"") + shade.fill + '"');
    svg.Text(legend_x + 24.0, 17.5, shade.label, "class=\"legend\"");
    legend_x += 48.0 + 7.6 * static_cast<double>(std::string_view(shade.label).size());
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double y = kTop + kRow * static_cast<double>(r);
    svg.Text(kLeft - 10.0, y + 14.0, rows[r].name, "class=\"tick\" text-anchor=\"end\"");
    svg.Rect(kLeft, y + 4.0, kWidth - kLeft - kRight, kRow - 8.0, "fill=\"#f3f4f6\"");
    for (const Stretch& stretch : rows[r].stretches) {
      svg.Rect(x(stretch.from_s), y + 4.0, std::max(1.0, x(stretch.to_s) - x(stretch.from_s)),
               kRow - 8.0, std::string("fill=\"") + shades[stretch.shade].fill + '"');
    }
    for (const double mark_s : rows[r].marks_s) {
      svg.Line(x(mark_s), y + 1.0, x(mark_s), y + kRow - 1.0,
               std::string("stroke=\"") + colour::kInk + "\" stroke-width=\"2\"");
    }
  }
  const double step = NiceStep(end_s, 14);
  for (double t = 0.0; t <= end_s + 1e-9; t += step) {
    svg.Line(x(t), bottom, x(t), bottom + 4.0, std::string("stroke=\"") + colour::kMuted + '"');
    svg.Text(x(t), bottom + 17.0, Number(t), "class=\"tick\" text-anchor=\"middle\"");
  }
  svg.Text((kLeft + kWidth - kRight) / 2.0, bottom + 33.0, "time [s]",
           "class=\"label\" text-anchor=\"middle\"");
  return svg.Finish() + (left_out.empty() ? "" : "<p class=\"note\">" + left_out + "</p>\n");
}

// The longest, then in order of their begin.
std::string KeepLongest(std::vector<StripRow>& rows, std::size_t at_most, const char* what) {
  std::string left_out;
  if (rows.size() > at_most) {
    left_out = std::to_string(rows.size() - at_most) + " of the shorter " + what + " left out.";
    std::ranges::stable_sort(rows, std::ranges::greater{}, &StripRow::length_s);
    rows.resize(at_most);
  }
  std::ranges::stable_sort(rows, {}, [](const StripRow& row) {
    return row.stretches.empty() ? 1e9 : row.stretches.front().from_s;
  });
  return left_out;
}

}  // namespace

std::string TrustStrips(const RunLog& log, std::vector<std::uint32_t> senders, Timestamp begin,
                        double end_s, std::size_t at_most) {
  std::map<std::uint32_t, StripRow> rows;
  for (const ReceivedList& list : log.lists[Index(ListKind::kV2v)]) {
    const double t_s = ToSeconds(list.stamp - begin);
    for (const ListedTrack& track : list.tracks) {
      if (!senders.empty() && std::ranges::find(senders, track.sender) == senders.end()) continue;
      Add(rows[track.sender], t_s,
          static_cast<std::size_t>(std::clamp(track.trust, 1, static_cast<int>(kTrust.size())) -
                                   1));
    }
  }
  for (const VerdictReport& report : log.reports) {
    const auto found = rows.find(report.sender);
    if (found == rows.end()) continue;
    found->second.marks_s.push_back(ToSeconds(report.received - begin));
  }
  std::vector<StripRow> chosen;
  for (auto& [sender, row] : rows) {
    row.name = SenderText(sender);
    chosen.push_back(std::move(row));
  }
  const std::string left_out = KeepLongest(chosen, at_most, "senders");
  return Draw(chosen, kTrust, end_s, left_out);
}

std::string TrackStrips(const RunLog& log, ListKind kind, Timestamp begin, double end_s,
                        std::size_t at_most) {
  const bool is_local = kind == ListKind::kLocal;
  const std::array<Shade, 3> shades = {{{"seen", is_local ? colour::kLocal : colour::kPriority},
                                        {"hidden", "#e0927f"},
                                        {"out of view", "#b3addb"}}};
  std::map<std::int64_t, StripRow> rows;
  for (const ReceivedList& list : log.lists[Index(kind)]) {
    const double t_s = ToSeconds(list.stamp - begin);
    for (const ListedTrack& track : list.tracks) {
      Add(rows[track.id], t_s, static_cast<std::size_t>(std::clamp(track.visibility, 0, 2)));
    }
  }
  std::vector<StripRow> chosen;
  for (auto& [id, row] : rows) {
    row.name = std::to_string(id % 1'000'000);
    chosen.push_back(std::move(row));
  }
  const std::string left_out = KeepLongest(chosen, at_most, "tracks");
  return Draw(chosen, shades, end_s, left_out);
}

}  // namespace v2vouch::evaluation
