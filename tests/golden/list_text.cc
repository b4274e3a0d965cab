// SPDX-License-Identifier: Apache-2.0
#include "tests/golden/list_text.h"

#include <fmt/format.h>

#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch::testing {
namespace {

constexpr std::int64_t kBetweenLists_us = 500'000;

std::string Number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const std::string text = fmt::format("{:.{}f}", value, digits);
  // "-0.00" and "0.00" are the same figure.
  return text.find_first_not_of("-0.") == std::string::npos ? fmt::format("{:.{}f}", 0.0, digits)
                                                            : text;
}

std::string Hex(const std::uint8_t* octets, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{:02x}", octets[i]);
  return text;
}

const char* ClassName(int object_class) {
  constexpr const char* kNames[] = {"unknown", "car",        "van",        "truck",
                                    "bus",     "motorcycle", "pedestrian", "cyclist"};
  return object_class >= 0 && object_class < 8 ? kNames[object_class] : "?";
}

const char* VisibilityName(int visibility) {
  constexpr const char* kNames[] = {"visible", "hidden", "out-of-view"};
  return visibility >= 0 && visibility < 3 ? kNames[visibility] : "?";
}

const char* TrustName(int trust) {
  constexpr const char* kNames[] = {"none",    "unknown", "candidate", "validated",
                                    "bridged", "suspect", "revoked"};
  return trust >= 0 && trust < 7 ? kNames[trust] : "?";
}

double Sigma(const double* covariance, int i) { return std::sqrt(covariance[7 * i]); }

}  // namespace

void ListText::Add(const Outbox::Message& message) {
  if (message.channel == "MISBEHAVIOR") {
    if (const auto report = wire::Decode<misbehavior_report_t>(message.bytes)) AddReport(*report);
  } else if (message.channel.starts_with("TRACKS_")) {
    if (const auto list = wire::Decode<track_list_t>(message.bytes)) {
      AddList(message.channel.substr(7), *list);
    }
  }
}

void ListText::AddRefusals(const Engine& engine) {
  text_ += "refused\n";
  for (const RefusalTable::Row& row : engine.refusal_details()) {
    text_ += fmt::format("  {} {} {} {}\n", row.channel, ReasonName(row.refusal.reason),
                         row.refusal.field.empty() ? "-" : row.refusal.field, row.count);
  }
}

std::string ListText::Time(std::int64_t utime) {
  if (begin_ == 0) begin_ = utime;
  return fmt::format("t={:.2f}", static_cast<double>(utime - begin_) * 1e-6);
}

std::string ListText::Name(char list, std::int64_t id) {
  if (id == 0) return "-";
  std::map<std::int64_t, int>& names = names_[list];
  const auto [at, is_new] = names.try_emplace(id, static_cast<int>(names.size()) + 1);
  return fmt::format("{}{}", list, at->second);
}

void ListText::AddList(const std::string& channel, const track_list_t& list) {
  const std::string time = Time(list.utime);
  std::int64_t& next = next_[channel];
  const bool steps_back = list.utime < next - kBetweenLists_us;
  if (list.utime < next && !steps_back) return;
  next = (list.utime / kBetweenLists_us + 1) * kBetweenLists_us;
  text_ += fmt::format("{} {} revision {}{}{}\n", time, channel, list.revision,
                       list.stale != 0 ? " stale" : "",
                       list.ego_gnss_suspect != 0 ? " gnss-suspect" : "");
  const char kind = channel[0] == 'V' ? 'S' : channel[0];
  for (const track_t& track : list.tracks) {
    text_ += fmt::format(
        "  {} {} x {} y {} yaw {} v {} w {} sigma {} {} {} {} size {} x {} exists {} {}",
        Name(kind, track.id), ClassName(track.object_class), Number(track.x_body_m, 2),
        Number(track.y_body_m, 2), Number(ToDegrees(track.yaw_body_rad), 1),
        Number(track.speed_mps, 2), Number(ToDegrees(track.yaw_rate_radps), 1),
        Number(Sigma(track.covariance_body, 0), 2), Number(Sigma(track.covariance_body, 1), 2),
        Number(ToDegrees(Sigma(track.covariance_body, 2)), 1),
        Number(Sigma(track.covariance_body, 3), 2), Number(track.length_m, 1),
        Number(track.width_m, 1), Number(track.existence, 2), VisibilityName(track.visibility));
    if (kind != 'L') {
      text_ += fmt::format(" on {} sender {} {} budget {} bias {} {}", Name('L', track.local_id),
                           Hex(track.v2v_id, 4), TrustName(track.trust_state),
                           Number(track.bridge_budget_s, 1), Number(track.bias_east_m, 2),
                           Number(track.bias_north_m, 2));
    }
    text_ += '\n';
  }
}

void ListText::AddReport(const misbehavior_report_t& report) {
  text_ += fmt::format("{} {} {} {}\n", Time(report.utime),
                       report.verdict == misbehavior_report_t::ACCUSE ? "ACCUSE" : "WITHDRAW",
                       Hex(report.sender_id, 4), report.check);
}

}  // namespace v2vouch::testing
