// SPDX-License-Identifier: Apache-2.0
// Blocks that change when a message is from, and whose it is said to be.
#include <algorithm>
#include <cmath>

#include "sim/attacks/change.h"
#include "sim/sensors/bsm.h"

namespace v2vouch::sim {

void Change::Remember(const Message& message) {
  double keep_s = 0.0;
  if (spec_.delay) {
    // So many messages take no more seconds, as nobody sends less than one in a second.
    keep_s = std::max(spec_.delay->high_s, static_cast<double>(spec_.delay->messages));
  } else if (spec_.replay && spec_.replay->of == ReplaySpec::Of::kOwn) {
    keep_s = spec_.replay->age_s;
  } else {
    return;
  }
  past_.push_back(message);
  while (past_.front().time_s < message.time_s - keep_s - 1.0) past_.pop_front();
}

Message Change::PastAt(double time_s, double age_s) const {
  const double then = time_s - age_s;
  const auto after = std::find_if(past_.begin(), past_.end(),
                                  [then](const Message& m) { return m.time_s > then; });
  if (after != past_.begin()) return *std::prev(after);
  Message message = past_.front();
  CarryOn(message.said, then - message.time_s);
  message.said.time_s = then;
  message.stamp_s = then;
  message.signed_s = then;
  return message;
}

void Change::Alter(const DelaySpec& spec, const Moment& now, Message& message) {
  if (IsToBeDrawn(Draw::kOnce)) drawn_ = random_.Uniform(spec.low_s, spec.high_s);
  Message then;
  if (spec.messages > 0) {
    const auto back = std::min(past_.size() - 1, static_cast<std::size_t>(spec.messages));
    then = past_[past_.size() - 1 - back];
  } else {
    then = PastAt(now.time_s, drawn_);
  }
  message.said = then.said;
  if (spec.restamp) return;
  message.stamp_s = then.stamp_s;
  message.signed_s = then.signed_s;
}

void Change::Alter(const ReplaySpec& spec, const Moment& now, Message& message) {
  if (spec.of == ReplaySpec::Of::kVictim) return ReplayVictim(spec, now, message);
  const Message then = PastAt(now.time_s, spec.age_s);
  message.said = then.said;
  if (spec.stamps == ReplaySpec::Stamps::kMinute) message.signed_s = now.time_s - 60.0;
  if (spec.stamps != ReplaySpec::Stamps::kKept) return;
  message.stamp_s = then.stamp_s;
  message.signed_s = then.signed_s;
  message.signed_after_s = then.signed_after_s;
  message.identity = then.identity;
  message.msg_count = then.msg_count;
}

void Change::ReplayVictim(const ReplaySpec& spec, const Moment& now, Message& message) {
  const double then = now.time_s - spec.age_s;
  if (left_ == 0) {
    std::vector<std::uint32_t> near;
    for (const auto& [vehicle, messages] : *speaker_.heard) {
      if (vehicle == speaker_.device || messages.empty() || messages.front().time_s > then)
        continue;
      const auto last = std::find_if(messages.rbegin(), messages.rend(),
                                     [&](const Message& m) { return m.time_s <= now.time_s; });
      if (last == messages.rend()) continue;
      const Vec2 way = last->said.centre - message.said.centre;
      if (way.norm() <= spec.within_m) near.push_back(vehicle);
    }
    acts_ = !near.empty();
    if (near.empty()) return;
    const auto pick =
        static_cast<std::size_t>(random_.Uniform() * static_cast<double>(near.size()));
    victim_ = near[pick];
    const double spread = 1.0 + spec.high - spec.low;
    left_ = spec.low + static_cast<int>(random_.Uniform() * spread);
    replayed_s_ = then - 0.5;  // The next one after this is the first.
  }
  const auto& messages = speaker_.heard->at(victim_);
  const auto next = std::find_if(messages.begin(), messages.end(), [&](const Message& m) {
    return m.time_s > replayed_s_ && m.time_s > then - 0.5;
  });
  --left_;
  if (next == messages.end() || next->time_s > now.time_s) {
    left_ = 0;
    acts_ = false;
    return;
  }
  replayed_s_ = next->time_s;
  message.said = next->said;
  if (spec.stamps == ReplaySpec::Stamps::kMinute) message.signed_s = now.time_s - 60.0;
  if (spec.stamps != ReplaySpec::Stamps::kKept) return;
  message.stamp_s = next->stamp_s;
  message.signed_s = next->signed_s;
  message.signed_after_s = next->signed_after_s;
}

void Change::Alter(const IdentityChangeSpec& spec, const Moment& now, Message& message) {
  int number = spec.at_once ? 1 : 0;
  if (spec.every_messages > 0) number += now.number / spec.every_messages;
  if (spec.every_s > 0.0) number += static_cast<int>(now.elapsed_s / spec.every_s);
  acts_ = number > 0;
  if (number == 0) return;
  if (count_ < 0) count_ = static_cast<int>(random_.Uniform() * 128.0);
  message.identity = IdentityOf(scene_.seed, speaker_.device, speaker_.first_identity + number);
  message.msg_count = count_++ % 128;
}

void Change::Alter(const ImpersonateSpec& spec, const Moment& now, Message& message) {
  const auto& actors = scene_.world.actors();
  const Actor* victim = nullptr;
  double longest_s = -1.0;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    if (!actors[i].has_v2v || actors[i].id == speaker_.device) continue;
    const std::uint32_t wanted = spec.vehicle != 0 ? spec.vehicle : message.vehicle;
    const double in_view_s = scene_.views != nullptr ? scene_.views->LongestInView(i) : 0.0;
    if (actors[i].id != wanted && in_view_s <= longest_s) continue;
    longest_s = actors[i].id == wanted ? 1e18 : in_view_s;
    victim = &actors[i];
  }
  acts_ = victim != nullptr;
  if (victim == nullptr) return;
  const Identity stolen =
      IdentityOf(scene_.seed, victim->id, IdentityNumber(victim->sender, now.time_s));
  message.identity.id = stolen.id;
  if (spec.certificate == ImpersonateSpec::Certificate::kNone) {
    message.identity.certificate.fill(0);
    message.signature_state = 0;
  }
}

}  // namespace v2vouch::sim
