// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/doctor/bus_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/common/base/refusal_tally.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/type_table.h"

namespace v2vouch {
namespace {

using State = Advice::State;

constexpr double kClockTolerance_s = 0.5;  // A camera through a network is 0.3 s late.
constexpr std::size_t kMostStamps = 1000;

constexpr double kDay_s = 86400.0;

std::string_view TypeFor(wire::InputKind kind) {
  switch (kind) {
    case wire::InputKind::kRadar:
      return "radar_scan_t";
    case wire::InputKind::kCameraBoxes:
      return "camera_detections_t";
    case wire::InputKind::kCameraImage:
      return "camera_image_t";
    case wire::InputKind::kObjects:
      return "object_list_t";
    case wire::InputKind::kEgoMotion:
      return "ego_motion_t";
    case wire::InputKind::kGnss:
      return "gnss_fix_t";
    case wire::InputKind::kBsm:
    case wire::InputKind::kOwnBsm:
      return "bsm_t";
  }
  return "";
}

std::string Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", value);
  return text;
}

std::string Span(double seconds) {
  const double size = std::abs(seconds);
  return size < kDay_s ? Rounded(size) + " s" : Rounded(size / kDay_s) + " days";
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string ClockAdvice(const std::string& channel, double lateness_s) {
  if (std::abs(lateness_s + 18.0) < 1.0 || std::abs(lateness_s - 18.0) < 1.0) {
    return channel +
           " is 18 s off: GPS time instead of UTC. Take the leap seconds into account "
           "where its utime is made";
  }
  if (std::abs(std::remainder(lateness_s, 3600.0)) < 1.0) {
    return channel + " is whole hours off: local time instead of UTC where its utime is made";
  }
  if (std::abs(lateness_s) > 1e8) {
    return channel +
           "'s utime is no time of day: is it microseconds since 1970, or time since "
           "boot, milliseconds, nanoseconds?";
  }
  if (std::abs(lateness_s) > kDay_s) {
    return "is a recorded drive being played? Else set " + channel + "'s clock";
  }
  return "synchronise the clocks (PTP, or chrony against the GNSS receiver), or set the sensor's "
         "clock offset in the vehicle file";
}

}  // namespace

BusCheck::BusCheck(const DaemonConfig& config)
    : config_(config), decoder_(config.perception.vehicle, config.lcm.channels) {}

void BusCheck::Hear(std::string_view channel, std::span<const std::uint8_t> bytes,
                    Timestamp received) {
  if (channel == "V2VOUCH_DOCTOR") return;
  auto found = heard_.find(channel);
  if (found == heard_.end()) {
    if (heard_.size() >= 1000) return;
    found = heard_.emplace(std::string(channel), Heard{}).first;
  }
  Heard& heard = found->second;
  ++heard.count;
  const wire::WireType* type = wire::TypeOf(bytes);
  heard.type = type ? std::string(type->layout->name) : "";
  if (type && type->layout->fields[0].name == "utime" && bytes.size() >= 16 &&
      heard.lateness_s.size() < kMostStamps) {
    std::uint64_t utime = 0;
    for (std::size_t i = 8; i < 16; ++i) utime = (utime << 8) | bytes[i];
    heard.lateness_s.push_back((static_cast<double>(ToMicros(received)) -
                                static_cast<double>(static_cast<std::int64_t>(utime))) *
                               1e-6);
  }
  if (const auto input = decoder_.Find(channel)) {
    RefusalTally dropped;
    const auto decoded = decoder_.Decode(*input, bytes, received, dropped);
    if (decoded) {
      ++heard.accepted;
    } else {
      ++heard.refused[decoded.reason()];
    }
  }
  if (channel == config_.lcm.channels.status) {
    const auto status = wire::Decode<daemon_status_t>(bytes);
    if (!status) return;
    ++statuses_;
    if (last_status_seq_ >= 0 && status->seq != last_status_seq_ + 1) ++status_breaks_;
    last_status_seq_ = status->seq;
    status_ = *status;
  }
}

AdviceList BusCheck::Finish(std::chrono::duration<double> listened) const {
  AdviceList findings;
  CheckInputs(findings, listened);
  CheckStrangers(findings);
  CheckClocks(findings);
  CheckDaemons(findings, listened);
  return findings;
}

void BusCheck::CheckInputs(AdviceList& findings, std::chrono::duration<double> listened) const {
  std::vector<std::string> strangers;
  for (const auto& [name, heard] : heard_) {
    if (!decoder_.Find(name)) strangers.push_back(name);
  }
  for (const wire::InputChannel& input : decoder_.channels()) {
    const auto found = heard_.find(input.name);
    if (found == heard_.end()) {
      if (input.is_optional()) continue;
      const bool is_v2v = input.is_v2v() || input.kind == wire::InputKind::kGnss;
      findings.push_back(
          {is_v2v ? State::kNote : State::kBad, "silent",
           input.name + ": nothing heard in " + Rounded(listened.count()) + " s" +
               DidYouMean(input.name, strangers),
           is_v2v ? "nobody near who sends, or its source does not run; without it there is no "
                    "PRIORITY"
                  : "start its source, or take it out of the vehicle file; is the source on the "
                    "same LCM URL?"});
      continue;
    }
    const Heard& heard = found->second;
    const std::string count = std::to_string(heard.count) + " messages";
    if (!heard.refused.empty()) {
      std::vector<std::string> reasons;
      for (const auto& [reason, times] : heard.refused) {
        reasons.push_back(std::string(ReasonName(reason)) + " " + std::to_string(times));
      }
      const std::string text = input.name + ": of " + count + " refused: " + Listed(reasons, 4);
      if (heard.type != TypeFor(input.kind)) {
        findings.push_back(
            {State::kBad, "type",
             text + "; it carries " + (heard.type.empty() ? "an unknown type" : heard.type) +
                 " where " + std::string(TypeFor(input.kind)) + " belongs",
             heard.type.empty() ? "build the sender with the .lcm files of this version"
                                : "two channels' names are mixed up, or the channel is configured "
                                  "for another kind of sensor"});
      } else {
        findings.push_back({heard.accepted == 0 ? State::kBad : State::kNote, "content", text,
                            "docs/how-to/tune-and-troubleshoot.md has each reason"});
      }
      continue;
    }
    findings.push_back(
        {State::kGood, "input",
         input.name + ": " + Rounded(static_cast<double>(heard.count) / listened.count()) + " Hz",
         ""});
  }
}

void BusCheck::CheckStrangers(AdviceList& findings) const {
  std::vector<std::string> silent;
  for (const wire::InputChannel& input : decoder_.channels()) {
    if (!heard_.contains(input.name)) silent.push_back(input.name);
  }
  for (const auto& [name, heard] : heard_) {
    if (decoder_.Find(name)) continue;
    const std::string& type = heard.type;
    const bool is_input_type = std::ranges::any_of(
        decoder_.channels(), [&type](const auto& input) { return type == TypeFor(input.kind); });
    const std::string meant = DidYouMean(name, silent);
    if (!is_input_type && meant.empty()) continue;
    if (name.ends_with(config_.lcm.channels.detected_suffix)) continue;  // Our own network's.
    std::string what = name;
    what.append(": ").append(std::to_string(heard.count)).append(" messages (");
    what.append(type.empty() ? "unknown type" : type);
    what.append(") on a channel that no sensor of this vehicle has").append(meant);
    findings.push_back({State::kNote, "name", what,
                        "rename the channel where it is sent, or give the sensor this name in "
                        "vehicle.radars, cameras or objects"});
  }
}

void BusCheck::CheckClocks(AdviceList& findings) const {
  const std::string& gnss = config_.lcm.channels.ego_gnss;
  const auto fix = heard_.find(gnss);
  const bool has_gnss = fix != heard_.end() && !fix->second.lateness_s.empty();
  const double gnss_s = has_gnss ? Median(fix->second.lateness_s) : 0.0;
  for (const wire::InputChannel& input : decoder_.channels()) {
    const auto found = heard_.find(input.name);
    if (found == heard_.end() || found->second.lateness_s.empty() || input.is_v2v()) continue;
    // Against GNSS where there is one: this computer's clock may be the wrong one.
    const double lateness_s = Median(found->second.lateness_s) - gnss_s;
    if (input.name == gnss || std::abs(lateness_s) <= kClockTolerance_s) continue;
    findings.push_back({State::kBad, "clock",
                        input.name + " is " + Span(lateness_s) + " " +
                            (lateness_s > 0 ? "behind " : "ahead of ") +
                            (has_gnss ? gnss : "this computer's clock"),
                        ClockAdvice(input.name, lateness_s)});
  }
  if (!has_gnss) return;
  if (std::abs(gnss_s) <= kClockTolerance_s) {
    findings.push_back(
        {State::kGood, "clock", "this computer agrees with " + gnss + " within 0.5 s", ""});
    return;
  }
  findings.push_back({State::kNote, "clock",
                      gnss + " is " + Span(gnss_s) + (gnss_s > 0 ? " behind" : " ahead of") +
                          " this computer's clock",
                      ClockAdvice(gnss, gnss_s)});
}

void BusCheck::CheckDaemons(AdviceList& findings, std::chrono::duration<double> listened) const {
  if (statuses_ == 0) {
    findings.push_back({State::kNote, "daemon",
                        "no v2vouchd: nothing on " + config_.lcm.channels.status,
                        "start it: systemctl start v2vouchd, or v2vouchd --config FILE"});
    return;
  }
  // A restart breaks the count once; two daemons at every status but few.
  if (status_breaks_ >= 2 && static_cast<double>(statuses_) > 1.4 * listened.count()) {
    findings.push_back({State::kBad, "second_daemon",
                        "more than one v2vouchd publishes on " + config_.lcm.channels.status,
                        "pgrep -a v2vouchd shows those of this computer; end all but one, or give "
                        "the other a port of its own (another group on the same port separates "
                        "nothing)"});
  } else {
    findings.push_back(
        {State::kGood, "daemon", "one v2vouchd runs, version " + status_.version, ""});
  }
  for (const auto& notice : status_.notices) {
    findings.push_back(
        {State::kNote, notice.name,
         notice.channel.empty() ? "told by v2vouchd" : notice.channel + ", told by v2vouchd",
         notice.advice});
  }
}

}  // namespace v2vouch
