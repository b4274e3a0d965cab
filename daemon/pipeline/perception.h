// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/common/base/notice.h"
#include "daemon/common/data/bias.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/outputs.h"
#include "daemon/pipeline/perception_config.h"
#include "daemon/v2v/trust/trust_memory.h"

namespace v2vouch {

/// All of perception as one function of its past. Reads no clock, opens no socket, starts no
/// thread: the same inputs in the same order give the same outputs, bit for bit. Late inputs are
/// put in their place by rolling back to a checkpoint and stepping again (see timeline.h).
class Perception {
 public:
  /// @param bias where GPS bias estimates come from; NullBiasEstimator where there is none.
  Perception(const PerceptionConfig& config, std::unique_ptr<BiasEstimator> bias);
  ~Perception();
  Perception(Perception&&) noexcept;
  Perception& operator=(Perception&&) noexcept;

  /// Takes one input in order of arrival. `outputs` is cleared and reused.
  /// @return why the input was refused; nullopt: it was taken. A claim that waits for the next
  /// frame counts as taken; a refusal of it then is among the diagnostics of that step.
  std::optional<Reason> Step(const Input& input, Outputs& outputs);

  /// This car itself sends under this id: a BSM under it is our own echo, whatever it claims.
  void NoteOwnId(SenderId id, Timestamp at);

  /// Copies of the newest lists predicted to `at` (not before the newest frame), marked stale, all
  /// sectors blind; empty once a hidden vehicle would be given up. Changes no state.
  void PredictedLists(Timestamp at, Outputs& outputs) const;

  /// What time it is by most own sensors; nullopt before the first message.
  [[nodiscard]] std::optional<Timestamp> agreed_time() const;

  /// What of the trust in senders outlives a restart, as of the newest event; and where it goes
  /// back to, before the first input.
  [[nodiscard]] std::vector<TrustMemory> TrustToKeep() const;
  void RestoreTrust(std::vector<TrustMemory> memories);

  /// Newest time of any own-sensor frame; the clock of everything that is published.
  [[nodiscard]] Timestamp newest_frame() const;
  [[nodiscard]] int sender_count() const;
  [[nodiscard]] bool ego_gnss_suspect() const;
  /// The newest settled GPS bias estimates.
  [[nodiscard]] const BiasReport& bias_report() const;
  /// Adds the conditions that hold now (daemon/common/base/notice.h).
  void CollectNotices(std::vector<Notice>& notices) const;
  /// Whether a configured sensor has spoken within three of its periods.
  [[nodiscard]] bool IsAlive(SensorKey sensor) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace v2vouch
