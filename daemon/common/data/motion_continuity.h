// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Do two messages of a sender continue each other? Three questions of that kind, from the coarsest
/// to the finest, each with its distance here; docs/explain/message-checks.md tells why they
/// differ.
///
/// Does the motion start anew? A displacement beyond this and beyond kMostRoadSpeed_mps x dt is
/// none of one vehicle: the sender's filter drops what it knew.
inline constexpr double kRestart_m = 10.0;
/// Is it a jump to be reported (position_jump)? What the claimed motion leaves unexplained.
/// Measured on real units' recordings (docs/results/messages.md); default of v2v.checks.jump_m.
inline constexpr double kJump_m = 8.0;
/// Does a message continue the last one closely enough that a residual's jump is not its doing?
/// Beside three sigma of its noise and half of kUnannounced_mps2 dt^2.
inline constexpr double kContinues_m = 2.0;
inline constexpr double kContinues_mps = 2.0;
/// Acceleration that a message need not announce: braking begins between two messages.
inline constexpr double kUnannounced_mps2 = 4.0;

}  // namespace v2vouch
