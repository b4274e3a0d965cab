// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "sim/behaviour/evaluation.h"
#include "sim/spoofing/spoof_run.h"

namespace v2vouch::evaluation {

/// What is known of the liars of a run: the log once more, read with ReadScope::kSpoof, and its
/// judgement. Both empty where the log does not say what became of each BSM.
struct LiarFacts {
  RunLog log;
  std::optional<SpoofRun> judged;
  [[nodiscard]] bool has_liar() const { return judged && judged->false_messages > 0; }
};

/// One paragraph of what happened, in plain text: the vehicle that was unseen for longest and what
/// each list made of that, how complete LOCAL was, what became of the liars.
/// `liars` may be null.
std::string Story(const Evaluation& evaluation, const LiarFacts* liars);

/// The same of a run without truth: what was listed, what PRIORITY kept while no sensor saw it,
/// who was withdrawn or accused.
std::string StoryWithoutTruth(const RunLog& log);

/// A sender's id as in the lists' v2v_id.
std::string SenderText(std::uint32_t sender);

}  // namespace v2vouch::evaluation
