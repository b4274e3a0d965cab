// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/plain_words.h"

#include <algorithm>
#include <cmath>

#include "daemon/programs/spy/field_tree.h"
#include "daemon/programs/spy/printable.h"
#include "daemon/rim/message_schema/message_schema.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::spy {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c == '_' ? ' ' : static_cast<char>(std::tolower(c));
  return lower;
}

std::string NameOf(std::string_view prefix, int value) {
  static const message_schema::Type* track = message_schema::FindType("track_t");
  return Lower(message_schema::ConstantName(*track, prefix, value));
}

std::string VisibilityOf(int value) {
  return value == track_t::VISIBLE       ? "visible"
         : value == track_t::HIDDEN      ? "hidden"
         : value == track_t::OUT_OF_VIEW ? "out of view"
                                         : "?";
}

std::string SourcesOf(const track_t& track, std::int64_t now_us) {
  std::string text;
  for (const track_source_t& source : track.sources) {
    if (!text.empty()) text += ", ";
    const std::string name =
        source.kind == track_source_t::V2V ? "v2v" : Printable(source.name, 24);
    text +=
        name + ' ' +
        DurationText(1e-6 * (static_cast<double>(now_us) - static_cast<double>(source.last_utime)));
  }
  return text;
}

std::string NoticeWords(const notice_t& notice) {
  std::string line = Lower(Printable(notice.name));
  if (!notice.channel.empty()) line += " (" + Printable(notice.channel, 63) + ")";
  if (std::isfinite(notice.value)) line += Format(" %.3g", notice.value);
  return line + ": " + Printable(notice.advice, 400);
}

void AddInputWords(const input_status_t& input, std::vector<std::string>& wrong,
                   std::vector<std::string>& rest) {
  const std::string name = Printable(input.channel, 63);
  const std::int64_t refused = input.received - input.accepted;
  if (input.received == 0) {
    wrong.push_back(name + " has never sent anything.");
  } else if (input.is_silent != 0) {
    wrong.push_back(name + " is silent: its newest message is " + DurationText(input.age_s) +
                    " old.");
  } else {
    std::string line = name + Format(": %.1f per second, newest ", input.rate_hz) +
                       DurationText(input.age_s) + " old";
    if (refused > 0) line += Format(", %lld refused", static_cast<long long>(refused));
    if (input.gaps > 0)
      line += Format(", %lld lost on the way", static_cast<long long>(input.gaps));
    rest.push_back(line + '.');
  }
}

void AddDropWords(const daemon_status_t& status, std::vector<std::string>& wrong) {
  if (status.kernel_drops > 0) {
    wrong.push_back(
        Format("The kernel has dropped %lld datagrams: raise net.core.rmem_max and "
               "recv_buf_size.",
               static_cast<long long>(status.kernel_drops)));
  }
  if (status.queue_drops_own > 0) {
    wrong.push_back(Format("%lld own-sensor messages were dropped: the daemon does not keep up.",
                           static_cast<long long>(status.queue_drops_own)));
  }
  if (status.queue_drops_bsm > 0) {
    wrong.push_back(Format("%lld BSMs were dropped: more than the daemon can take.",
                           static_cast<long long>(status.queue_drops_bsm)));
  }
}

}  // namespace

std::vector<std::string> TrackTable(std::span<const std::uint8_t> message) {
  auto decoded = wire::Decode<track_list_t>(message);
  if (!decoded) return {};
  track_list_t& list = *decoded;
  std::ranges::sort(list.tracks, {}, [](const track_t& track) {
    const double range = std::hypot(track.x_body_m, track.y_body_m);
    return std::isfinite(range) ? range : 1e9;
  });
  std::vector<std::string> lines;
  lines.push_back(Format("%d vehicles%s%s", list.num_tracks,
                         list.stale != 0 ? ", STALE: no own sensor for 100 ms" : "",
                         list.ego_gnss_suspect != 0 ? ", the ego's own GNSS is doubted" : ""));
  for (const sector_health_t& sector : list.sectors) {
    if (sector.state == sector_health_t::WATCHED) continue;
    constexpr double kDegrees = 57.29577951308232;
    lines.push_back(Format("  %s from %.0f to %.0f deg",
                           sector.state == sector_health_t::BLIND ? "BLIND" : "degraded",
                           sector.from_rad * kDegrees, sector.to_rad * kDegrees));
  }
  lines.push_back(
      "  id     class       x [m]   y [m]  v [m/s]  exist  seen         trust      budget  "
      "sender    last measured");
  for (const track_t& track : list.tracks) {
    const bool has_sender = track.trust_state != track_t::TRUST_NONE;
    lines.push_back(Format("  %-6lld %-10s %6.1f  %6.1f   %6.1f   %4.2f  %-11s  %-9s  %6s  ",
                           static_cast<long long>(track.id % 1'000'000),
                           NameOf("CLASS_", track.object_class).c_str(), track.x_body_m,
                           track.y_body_m, track.speed_mps, track.existence,
                           VisibilityOf(track.visibility).c_str(),
                           has_sender ? NameOf("TRUST_", track.trust_state).c_str() : "",
                           std::isfinite(track.bridge_budget_s)
                               ? Format("%.1f s", track.bridge_budget_s).c_str()
                               : "") +
                    (has_sender ? Format("%02x%02x%02x%02x  ", track.v2v_id[0], track.v2v_id[1],
                                         track.v2v_id[2], track.v2v_id[3])
                                : std::string(10, ' ')) +
                    SourcesOf(track, list.utime));
  }
  return lines;
}

std::vector<std::string> StatusWords(std::span<const std::uint8_t> message) {
  auto decoded = wire::Decode<daemon_status_t>(message);
  if (!decoded) return {};
  const daemon_status_t& status = *decoded;
  std::vector<std::string> wrong;
  std::vector<std::string> rest;
  for (const notice_t& notice : status.notices) wrong.push_back(NoticeWords(notice));
  for (const input_status_t& input : status.inputs) AddInputWords(input, wrong, rest);
  for (const refusal_t& refusal : status.refusal_details) {
    rest.push_back(Format("%lld of ", static_cast<long long>(refusal.count)) +
                   Printable(refusal.channel, 63) +
                   " refused: " + Lower(Printable(refusal.reason)) +
                   (refusal.field.empty() ? "" : ", field " + Printable(refusal.field)) + '.');
  }
  AddDropWords(status, wrong);
  if (status.ego_gnss_suspect != 0) {
    wrong.push_back("The ego's own GNSS jumped or disagrees: the V2V side stands still.");
  }
  for (const mount_status_t& mount : status.mounts) {
    if (mount.has_moved != 0) {
      wrong.push_back(Printable(mount.sensor, 63) +
                      " has moved in its mount: measure it, calibrate again.");
    }
  }
  rest.push_back(Format("Tracks: %d LOCAL, %d PRIORITY; %d V2V senders.", status.local_tracks,
                        status.priority_tracks, status.v2v_senders));
  for (const stage_latency_t& latency : status.latencies) {
    rest.push_back(Printable(latency.stage, 40) + Format(": median %.2f ms, 99 %% below %.2f ms.",
                                                         latency.p50_us / 1e3,
                                                         latency.p99_us / 1e3));
  }
  rest.push_back("Version " + Printable(status.version, 40) + ", calibration " +
                 Printable(status.calibration, 80) + '.');
  std::vector<std::string> lines = wrong;
  if (wrong.empty()) lines.emplace_back("All is well.");
  for (std::size_t i = 0; i < wrong.size(); ++i) lines[i] = "! " + lines[i];
  lines.insert(lines.end(), rest.begin(), rest.end());
  return lines;
}

std::vector<std::string> Describe(std::span<const std::uint8_t> message) {
  const message_schema::Type* type = message_schema::TypeOf(message);
  std::vector<std::string> lines;
  if (type != nullptr && type->name == "track_list_t") lines = TrackTable(message);
  if (type != nullptr && type->name == "daemon_status_t") lines = StatusWords(message);
  return lines.empty() ? FieldTree(message) : lines;
}

}  // namespace v2vouch::spy
