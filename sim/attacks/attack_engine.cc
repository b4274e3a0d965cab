// SPDX-License-Identifier: Apache-2.0
#include "sim/attacks/attack_engine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/attacks/selection.h"
#include "sim/sensors/subject.h"

namespace v2vouch::sim {
namespace {

constexpr int kVoicesPerAttack = 100;
constexpr int kIdentitiesPerVoice = 100000;

int VoicesOf(const PathSpec& path) {
  if (path.shadow) return path.shadow->count;
  if (path.grid) return path.grid->count;
  return 1;
}

}  // namespace

// One identity that a transmitter speaks with.
struct AttackEngine::Voice {
  int number = 0;  ///< Among the attack's; own_voice below tells whether it is the unit's own.
  bool is_own = false;
  Identity identity;  ///< Unless it is the own one.
  int msg_count = 0;
  double late_s = 0.0;  ///< Behind the first voice, so that not all speak at once.
  Gate gate;
  ClaimedPath path;
  std::vector<Change> changes;
  Random random;
};

// One transmitter in one attack.
struct AttackEngine::Liar {
  const AttackSpec& attack;
  std::uint32_t device = 0;
  std::optional<std::size_t> actor;  ///< Whose view the gates ask about.
  double period_s = 0.1;
  std::vector<Voice> voices;
};

AttackEngine::AttackEngine(const World& world, std::uint64_t seed)
    : world_(world), seed_(seed), line_(world) {
  const std::vector<AttackSpec>& attacks = world.scenario().attacks;
  if (std::any_of(attacks.begin(), attacks.end(), NeedsViews)) views_.emplace(world, seed);
  scene_.emplace(AttackScene{world, seed, line_, views_ ? &*views_ : nullptr});
  std::uint32_t next_device = kFirstDeviceId;
  for (std::size_t index = 0; index < attacks.size(); ++index) {
    const AttackSpec& attack = attacks[index];
    const auto victim = ChooseVictim(attack, *scene_, notes_);
    for (const ChangeSpec& change : attack.change) {
      listens_ = listens_ || (change.replay && change.replay->of == ReplaySpec::Of::kVictim);
    }
    for (int k = 0; k < attack.who.devices; ++k, ++next_device) {
      if (attack.path.flood) {
        floods_.emplace_back(attack, world, next_device, seed);
        continue;
      }
      devices_.push_back(BsmSender::Device(world, next_device, seed));
      AddLiar(attack, index, next_device, std::nullopt, victim);
    }
    const auto attackers =
        attack.who.devices > 0 ? std::vector<std::size_t>{} : ChooseAttackers(attack.who, *scene_);
    for (const std::size_t i : attackers) {
      AddLiar(attack, index, world.actors()[i].id, i, victim);
    }
    if (attack.who.devices == 0 && attackers.empty()) {
      notes_.push_back(attack.name + ": nobody in this run can be the attacker");
    }
  }
}

AttackEngine::~AttackEngine() = default;

void AttackEngine::AddLiar(const AttackSpec& attack, std::size_t index, std::uint32_t device,
                           std::optional<std::size_t> actor, std::optional<std::size_t> victim) {
  auto liar = std::make_unique<Liar>(Liar{attack, device, actor, 0.1, {}});
  if (attack.path.shadow && victim) liar->actor = victim;
  const double own_rate = actor ? world_.actors()[*actor].sender.rate_hz : 0.0;
  liar->period_s = 1.0 / (own_rate > 0.0 ? own_rate : world_.scenario().bsm.rate_hz);
  const int count = VoicesOf(attack.path);
  for (int k = 0; k < count; ++k) {
    Random random = SubjectRandom(seed_, "attack", {index, device, static_cast<std::uint64_t>(k)});
    const int number = static_cast<int>(index) * kVoicesPerAttack + k;
    const int first_identity = (number + 1) * kIdentitiesPerVoice;
    const Random for_path(random.Bits());
    Voice voice{.number = k,
                .is_own = k == 0 && !attack.path.beside_own,
                .identity = IdentityOf(seed_, device, first_identity),
                .msg_count = static_cast<int>(random.Uniform() * 128.0),
                .late_s = k * liar->period_s / count,
                .gate = Gate(attack.when),
                .path = ClaimedPath(attack.path, *scene_, victim, k, for_path),
                .changes = {},
                .random = random};
    for (std::size_t c = 0; c < attack.change.size(); ++c) {
      const Speaker speaker{device, first_identity, &heard_};
      const Random for_change =
          SubjectRandom(seed_, "attack block", {index, device, static_cast<std::uint64_t>(k), c});
      voice.changes.emplace_back(attack.change[c], *scene_, speaker, for_change);
    }
    liar->voices.push_back(std::move(voice));
  }
  liars_.push_back(std::move(liar));
}

void AttackEngine::Hear(const std::vector<Message>& messages) {
  if (!listens_) return;
  constexpr std::size_t kKept = 700;  // A minute and more at 10 Hz.
  for (const Message& message : messages) {
    auto& heard = heard_[message.device];
    heard.push_back(message);
    if (heard.size() > kKept) heard.pop_front();
  }
}

void AttackEngine::Apply(double until_s, std::vector<Message>& messages) {
  if (liars_.empty()) return;
  Hear(messages);
  for (BsmSender& device : devices_) {
    while (device.next_time_s() < until_s) {
      auto message = device.NextMessage();
      if (!message) continue;
      message->vehicle = 0;
      message->honest.reset();
      messages.push_back(std::move(*message));
    }
  }
  for (const auto& liar : liars_) {
    std::vector<Message> sent;
    sent.reserve(messages.size());
    for (const Message& message : messages) {
      if (message.device == liar->device) {
        Lie(*liar, message, sent);
      } else {
        sent.push_back(message);
      }
    }
    messages = std::move(sent);
  }
}

void AttackEngine::AddFloods(double until_s, std::vector<RawMessage>& sent) {
  for (Flood& flood : floods_) flood.Run(until_s, sent);
}

void AttackEngine::Lie(Liar& liar, const Message& message, std::vector<Message>& sent) {
  const bool is_attacker = liar.attack.kind == AttackSpec::Kind::kAttack;
  // Identities that an earlier attack of this transmitter made are left to it.
  if (message.voice != 0 || liar.attack.path.beside_own) {
    sent.push_back(message);
    sent.back().is_attacker = is_attacker || message.is_attacker;
    if (message.voice != 0) return;
  }
  for (Voice& voice : liar.voices) Speak(liar, voice, message, sent);
}

void AttackEngine::Speak(Liar& liar, Voice& voice, const Message& message,
                         std::vector<Message>& sent) {
  const AttackSpec& attack = liar.attack;
  const bool is_device = message.device >= kFirstDeviceId;
  int times = 1;
  for (int copy = 0; copy < times; ++copy) {
    Message said = message;
    const double later_s = voice.late_s + copy * liar.period_s / times;
    if (later_s > 0.0) {
      CarryOn(said.said, later_s);
      if (said.honest) CarryOn(*said.honest, later_s);
      said.time_s += later_s;
      said.stamp_s += later_s;
      said.signed_s += later_s;
      said.is_lost = voice.random.Bernoulli(said.loss);
    }
    if (!voice.is_own) {
      said.voice = voice.number + 1;
      said.identity = voice.identity;
    }
    said.is_attacker = said.is_attacker || attack.kind == AttackSpec::Kind::kAttack;
    const EgoTruth ego = world_.At(said.time_s).ego;
    Circumstances now{said.time_s, 0.0, 0, ego.speed_mps, liar.actor, scene_->views};
    if (!voice.gate.Update(now)) {
      for (Change& change : voice.changes) change.Watch(said);
      if (voice.is_own && !is_device) sent.push_back(said);
      return;
    }
    now.since_attack_s = voice.gate.elapsed_s();
    now.attack_spell = voice.gate.spell();
    if (copy == 0) {
      for (Change& change : voice.changes) times *= change.Times(now);
    }
    const bool was_attack = said.is_attack;
    said.is_attack = times > 1;
    const Moment moment{said.time_s, voice.gate.elapsed_s(), voice.gate.number()};
    if (!voice.path.Rewrite(moment, said)) return;
    if (!voice.is_own || times > 1 || is_device) said.msg_count = voice.msg_count++ % 128;
    for (Change& change : voice.changes) change.Pass(now, said);
    if (attack.kind == AttackSpec::Kind::kHonest) said.is_attack = false;
    if (said.is_attack) said.attack += (said.attack.empty() ? "" : "+") + attack.name;
    said.is_attack = said.is_attack || was_attack;
    sent.push_back(std::move(said));
  }
}

}  // namespace v2vouch::sim
