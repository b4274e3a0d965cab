// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/sender_id.h"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"

namespace v2vouch::view {
namespace {

using wire::SenderOf;

constexpr std::size_t kMostSenders = 4096;
constexpr std::size_t kVerdictsKept = 10;
constexpr std::size_t kTrailPoints = 120;
constexpr double kTrailStep_m = 1.0;
constexpr double kTrailBreak_m = 30.0;  // The odometry frame began anew.
constexpr double kLongestStep_s = 1.0;

FlatPose EgoOf(const track_list_t& list) {
  return {list.ego_x_odom_m, list.ego_y_odom_m, list.ego_yaw_odom_rad};
}

bool IsFinite(const FlatPose& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

// Time from `from` to `to`, within bounds: stamps may be anything.
double SecondsBetween(std::int64_t from, std::int64_t to) {
  const double seconds = 1e-6 * (static_cast<double>(to) - static_cast<double>(from));
  return std::clamp(seconds, -kLongestStep_s, kLongestStep_s);
}

FlatPose MoveOn(const FlatPose& pose, double speed_mps, double yaw_rate_radps, double seconds) {
  const double middle = pose.yaw_rad + 0.5 * yaw_rate_radps * seconds;
  return {pose.x_m + speed_mps * seconds * std::cos(middle),
          pose.y_m + speed_mps * seconds * std::sin(middle),
          pose.yaw_rad + yaw_rate_radps * seconds};
}

}  // namespace

MapPoint FlatPose::ToOuter(double x_inner_m, double y_inner_m) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {x_m + c * x_inner_m - s * y_inner_m, y_m + s * x_inner_m + c * y_inner_m};
}

Scene::Scene(VehicleConfig vehicle, const wire::ChannelNames& names)
    : vehicle_(std::move(vehicle)) {
  radars_.resize(vehicle_.radars.size());
  objects_.resize(vehicle_.objects.size());
  boxes_.resize(vehicle_.cameras.size());
  pictures_.resize(vehicle_.cameras.size());
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    channels_[names.radar_prefix + vehicle_.radars[i].name] = {Kind::kRadar, i};
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    channels_[names.objects_prefix + vehicle_.objects[i].name] = {Kind::kObjects, i};
  }
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const std::string name = names.camera_prefix + vehicle_.cameras[i].name;
    const bool is_smart = vehicle_.cameras[i].source == CameraSource::kBoxes;
    channels_[is_smart ? name : name + names.detected_suffix] = {Kind::kBoxes, i};
    channels_[name + names.image_suffix] = {Kind::kPicture, i};
  }
  channels_[names.tracks_local] = {Kind::kList, 0};
  channels_[names.tracks_priority] = {Kind::kList, 1};
  channels_[names.tracks_v2v] = {Kind::kList, 2};
  channels_[names.ego_motion] = {Kind::kEgoMotion, 0};
  channels_[names.ego_gnss] = {Kind::kGnss, 0};
  channels_[names.status] = {Kind::kStatus, 0};
  channels_[names.misbehavior] = {Kind::kReport, 0};
  channels_[names.bsm_verdict] = {Kind::kVerdict, 0};
  channels_["WARNINGS"] = {Kind::kWarnings, 0};
  channels_["TRUTH"] = {Kind::kTruth, 0};
  channels_["TRUTH_BSM"] = {Kind::kTruthBsm, 0};
  channels_["SIM_SCENARIO"] = {Kind::kScenario, 0};
}

std::vector<std::string> Scene::Channels() const {
  std::vector<std::string> names;
  for (const auto& [name, channel] : channels_) names.push_back(name);
  return names;
}

void Scene::Forget() {
  for (auto& list : lists_) list = {};
  const auto clear = [](auto& newest) { newest.assign(newest.size(), {}); };
  clear(radars_);
  clear(objects_);
  clear(boxes_);
  clear(pictures_);
  ego_motion_ = {};
  gnss_ = {};
  status_ = {};
  truth_ = {};
  warnings_ = {};
  events_.Forget();
  verdicts_.clear();
  trail_.clear();
  list_utime_ = 0;
  list_received_ = 0;
  ++revision_;
}

template <class T>
bool Scene::Keep(std::span<const std::uint8_t> bytes, Newest<T>& newest) {
  Result<T> message = wire::Decode<T>(bytes);
  if (!message) {
    ++refused_;
    return false;
  }
  newest.message = std::move(*message);
  newest.revision = ++revision_;
  return true;
}

bool Scene::Take(std::string_view channel, std::span<const std::uint8_t> bytes,
                 Timestamp received) {
  const auto found = channels_.find(channel);
  if (found == channels_.end()) return false;
  received_ = ToMicros(received);
  const std::size_t i = found->second.index;
  switch (found->second.kind) {
    case Kind::kList:
      return TakeList(bytes, i);
    case Kind::kRadar:
      return Keep(bytes, radars_[i]);
    case Kind::kObjects:
      return Keep(bytes, objects_[i]);
    case Kind::kBoxes:
      return Keep(bytes, boxes_[i]);
    case Kind::kPicture:
      return Keep(bytes, pictures_[i]);
    case Kind::kEgoMotion:
      return Keep(bytes, ego_motion_);
    case Kind::kGnss:
      return Keep(bytes, gnss_);
    case Kind::kStatus:
      if (!Keep(bytes, status_)) return false;
      events_.TakeStatus(*status_.message, received_);
      return true;
    case Kind::kReport:
      return TakeReport(bytes);
    case Kind::kVerdict:
      return TakeVerdict(bytes);
    case Kind::kWarnings:
      if (!Keep(bytes, warnings_)) return false;
      events_.TakeWarnings(*warnings_.message, received_);
      return true;
    case Kind::kTruth:
      return Keep(bytes, truth_);
    case Kind::kTruthBsm:
      return TakeTruthBsm(bytes);
    case Kind::kScenario:
      return TakeScenario(bytes);
  }
  return false;
}

bool Scene::TakeList(std::span<const std::uint8_t> bytes, std::size_t index) {
  if (!Keep(bytes, lists_[index])) return false;
  const track_list_t& list = *lists_[index].message;
  if (index == static_cast<std::size_t>(List::kV2v)) return true;
  list_utime_ = list.utime;
  list_received_ = received_;
  if (index == static_cast<std::size_t>(List::kPriority)) {
    events_.TakePriority(list, received_);
  } else {
    ExtendTrail(list);
  }
  return true;
}

void Scene::ExtendTrail(const track_list_t& list) {
  const FlatPose ego = EgoOf(list);
  if (!IsFinite(ego)) return;
  if (!trail_.empty()) {
    const double step = std::hypot(ego.x_m - trail_.back().x_m, ego.y_m - trail_.back().y_m);
    if (step < kTrailStep_m) return;
    if (step > kTrailBreak_m) trail_.clear();
  }
  trail_.push_back({ego.x_m, ego.y_m});
  if (trail_.size() > kTrailPoints) trail_.pop_front();
}

void Scene::NoteVerdict(std::uint32_t sender, std::int64_t utime, std::string text) {
  if (verdicts_.size() >= kMostSenders && !verdicts_.contains(sender)) {
    verdicts_.erase(verdicts_.begin());
  }
  auto& verdicts = verdicts_[sender];
  if (!verdicts.empty() && verdicts.back().text == text) {
    verdicts.back().utime = utime;
    ++verdicts.back().times;
    return;
  }
  verdicts.push_back({utime, std::move(text), 1});
  if (verdicts.size() > kVerdictsKept) verdicts.pop_front();
}

bool Scene::TakeReport(std::span<const std::uint8_t> bytes) {
  Newest<misbehavior_report_t> newest;
  if (!Keep(bytes, newest)) return false;
  const misbehavior_report_t& report = *newest.message;
  events_.TakeReport(report, received_);
  std::string text = report.verdict == misbehavior_report_t::ACCUSE ? "accused: " : "withdrawn: ";
  text += CheckInWords(report.check);
  constexpr std::size_t kMostFigures = 6;
  for (std::size_t i = 0; i < std::min(report.evidence.size(), kMostFigures); ++i) {
    char figure[64];
    std::snprintf(figure, sizeof figure, "%.2f", report.evidence[i].value);
    text += (i == 0 ? " (" : ", ") + report.evidence[i].name + " " + figure;
  }
  if (!report.evidence.empty()) text += ")";
  NoteVerdict(SenderOf(report.sender_id), report.utime, std::move(text));
  return true;
}

bool Scene::TakeVerdict(std::span<const std::uint8_t> bytes) {
  Newest<bsm_verdict_t> newest;
  if (!Keep(bytes, newest)) return false;
  const bsm_verdict_t& verdict = *newest.message;
  NoteVerdict(SenderOf(verdict.sender_id), verdict.utime,
              verdict.refusal.empty() ? TrustInWords(verdict.trust_state)
                                      : "message refused: " + verdict.refusal);
  return true;
}

bool Scene::TakeTruthBsm(std::span<const std::uint8_t> bytes) {
  Newest<truth_bsm_t> newest;
  if (!Keep(bytes, newest)) return false;
  const std::uint32_t sender = SenderOf(newest.message->sender_id);
  if (newest.message->is_attack == 0) return true;
  if (liars_.size() < kMostSenders) liars_[sender] = true;
  return true;
}

bool Scene::TakeScenario(std::span<const std::uint8_t> bytes) {
  Newest<text_t> newest;
  if (!Keep(bytes, newest)) return false;
  map_.message = ReadRoadMap(newest.message->text);
  map_.revision = newest.revision;
  return true;
}

const std::deque<SenderVerdict>* Scene::VerdictsOf(std::uint32_t sender) const {
  const auto found = verdicts_.find(sender);
  return found == verdicts_.end() ? nullptr : &found->second;
}

bool Scene::IsLiar(std::uint32_t sender) const { return liars_.contains(sender); }

std::optional<FlatPose> Scene::EgoAt(std::int64_t utime) const {
  const auto& newest =
      lists_[0].revision >= lists_[1].revision ? lists_[0].message : lists_[1].message;
  if (!newest) return std::nullopt;
  const FlatPose pose = EgoOf(*newest);
  if (!IsFinite(pose)) return std::nullopt;
  double speed = 0.0, yaw_rate = 0.0;
  if (ego_motion_.message && std::isfinite(ego_motion_.message->speed_mps)) {
    speed = ego_motion_.message->speed_mps;
    if (std::isfinite(ego_motion_.message->yaw_rate_radps)) {
      yaw_rate = ego_motion_.message->yaw_rate_radps;
    }
  }
  return MoveOn(pose, speed, yaw_rate, SecondsBetween(newest->utime, utime));
}

std::optional<FlatPose> Scene::WorldInOdom() const {
  if (!truth_.message) return std::nullopt;
  const truth_list_t& truth = *truth_.message;
  const auto ego = EgoAt(truth.utime);
  const FlatPose in_world{truth.ego_x_m, truth.ego_y_m, truth.ego_yaw_rad};
  if (!ego || !IsFinite(in_world)) return std::nullopt;
  FlatPose world;
  world.yaw_rad = ego->yaw_rad - in_world.yaw_rad;
  const MapPoint turned = FlatPose{0.0, 0.0, world.yaw_rad}.ToOuter(in_world.x_m, in_world.y_m);
  world.x_m = ego->x_m - turned.x_m;
  world.y_m = ego->y_m - turned.y_m;
  return world;
}

}  // namespace v2vouch::view
