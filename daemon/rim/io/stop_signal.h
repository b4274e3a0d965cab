// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// SIGINT and SIGTERM ask the program to stop. Where it has not ended 0.8 s later (a long step, a
/// disk that does not answer) or is asked a second time, it ends there and then, with exit code 1.
void HandleStopSignals();

/// Whether a stop was asked for.
[[nodiscard]] bool IsStopAsked();

/// SIGHUP is only remembered from now on, instead of ending the program.
void HandleReloadSignal();

/// Whether SIGHUP has come since this was last asked.
[[nodiscard]] bool TakeReloadAsked();

}  // namespace v2vouch
