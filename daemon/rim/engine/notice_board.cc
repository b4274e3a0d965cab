// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/notice_board.h"

#include <algorithm>
#include <cstdio>
#include <tuple>

namespace v2vouch {
namespace {

constexpr std::size_t kMost = 256;  // As many as a status message may hold.

auto Order(const Notice& notice) {
  return std::tuple(notice.kind, notice.subject.kind, notice.subject.index);
}

bool IsChannelOf(const wire::InputChannel& channel, const NoticeSubject& subject) {
  const bool is_its_sensor = channel.sensor == static_cast<int>(subject.index);
  switch (subject.kind) {
    case NoticeSubject::Kind::kEgoMotion:
      return channel.kind == wire::InputKind::kEgoMotion;
    case NoticeSubject::Kind::kGnss:
      return channel.kind == wire::InputKind::kGnss;
    case NoticeSubject::Kind::kRadar:
      return channel.kind == wire::InputKind::kRadar && is_its_sensor;
    case NoticeSubject::Kind::kCamera:
      return is_its_sensor && (channel.kind == wire::InputKind::kCameraBoxes ||
                               channel.kind == wire::InputKind::kCameraImage);
    case NoticeSubject::Kind::kObjects:
      return channel.kind == wire::InputKind::kObjects && is_its_sensor;
    case NoticeSubject::Kind::kV2v:
    case NoticeSubject::Kind::kSender:
      return channel.kind == wire::InputKind::kBsm;
    case NoticeSubject::Kind::kCar:
      break;
  }
  return false;
}

}  // namespace

NoticeBoard::NoticeBoard(std::span<const wire::InputChannel> channels)
    : channels_(channels.begin(), channels.end()) {}

std::string NoticeBoard::ChannelOf(const NoticeSubject& subject) const {
  const auto found = std::ranges::find_if(
      channels_, [&](const wire::InputChannel& channel) { return IsChannelOf(channel, subject); });
  if (found == channels_.end()) return {};
  if (subject.kind != NoticeSubject::Kind::kSender) return found->name;
  char id[16];
  std::snprintf(id, sizeof(id), ":%08x", static_cast<unsigned>(subject.index));
  return found->name + id;
}

void NoticeBoard::Update(std::span<const Notice> notices, Timestamp now) {
  std::vector<Notice> next(notices.begin(), notices.end());
  std::ranges::sort(next, {}, Order);
  if (next.size() > kMost) next.resize(kMost);
  std::vector<wire::NoticeStatus> in_force;
  for (const Notice& notice : next) {
    const auto known = std::ranges::find(shown_, Order(notice), Order);
    if (known == shown_.end()) {
      in_force.push_back({.name = std::string(NoticeName(notice.kind)),
                          .channel = ChannelOf(notice.subject),
                          .value = notice.value,
                          .since = now,
                          .advice = std::string(NoticeAdvice(notice.kind))});
      Record(true, in_force.back());
    } else {
      in_force.push_back(in_force_[static_cast<std::size_t>(known - shown_.begin())]);
      in_force.back().value = notice.value;
    }
  }
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    if (std::ranges::find(next, Order(shown_[i]), Order) == next.end()) Record(false, in_force_[i]);
  }
  shown_ = std::move(next);
  in_force_ = std::move(in_force);
}

void NoticeBoard::Record(bool has_begun, const wire::NoticeStatus& notice) {
  if (changes_.size() >= kMost) changes_.erase(changes_.begin());
  changes_.push_back({has_begun, notice});
}

}  // namespace v2vouch
