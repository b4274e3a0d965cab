// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/attacks/change.h"
#include "sim/attacks/claimed_path.h"
#include "sim/attacks/flood.h"
#include "sim/attacks/gate.h"
#include "sim/sensors/bsm.h"
#include "sim/sensors/message.h"
#include "sim/world/world.h"

namespace v2vouch::sim {

/// The attacks of a scenario at work between the units and the radio: what each unit would honestly
/// send goes in, what is sent comes out. Reads the world's truth and nothing of the sensors' data,
/// so those stay as they are. The same scenario and seed give the same messages.
class AttackEngine {
 public:
  AttackEngine(const World& world, std::uint64_t seed);
  ~AttackEngine();

  /// @param messages all honest messages of the time since the last call, each unit's in order;
  /// replaced by those that are sent, lost ones among them.
  void Apply(double until_s, std::vector<Message>& messages);

  /// Appends what comes besides and is no unit's message, of the same time.
  void AddFloods(double until_s, std::vector<RawMessage>& sent);

  /// What the user should know: attacks that cannot happen in this run, for instance.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  struct Voice;
  struct Liar;

  void AddLiar(const AttackSpec& attack, std::size_t index, std::uint32_t device,
               std::optional<std::size_t> actor, std::optional<std::size_t> victim);
  void Lie(Liar& liar, const Message& message, std::vector<Message>& sent);
  void Speak(Liar& liar, Voice& voice, const Message& message, std::vector<Message>& sent);
  void Hear(const std::vector<Message>& messages);

  const World& world_;
  std::uint64_t seed_;
  EgoLine line_;
  std::optional<ViewTimeline> views_;
  std::optional<AttackScene> scene_;
  Heard heard_;
  bool listens_ = false;  ///< Some attack replays others' messages.
  std::vector<BsmSender> devices_;
  std::vector<Flood> floods_;
  std::vector<std::unique_ptr<Liar>> liars_;  ///< In the order of the scenario's attacks.
  std::vector<std::string> notes_;
};

}  // namespace v2vouch::sim
