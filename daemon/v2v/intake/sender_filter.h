// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/v2v/intake/intake.h"

namespace v2vouch {

/// Starts a sender's track from its first claim.
SenderTrack StartSender(const Bsm& bsm, const Claim& claim);

/// Takes the next claim into the track: CTRA prediction to its reception, then an EKF update with
/// the claimed place (carried over its age), direction and speed.
///
///     NIS = y^T S^-1 y,  4 degrees of freedom (3 without course), 99 % below 13.28 (11.34)
///
/// R has the claimed accuracy (at least 0.5 m) and, along the course, 0.15 s of speed: positions
/// of honest senders are older than their stamps by about that. A displacement over
/// max(70 m/s dt, 10 m), a silence over 2 s, or a NIS over 100 starts the motion anew.
/// `is_reread`: what the heading means has changed (DirectionReading); the motion starts anew
/// without being a break of the sender's own.
/// @return false when the numbers failed; the track is of no use then.
bool AdvanceSender(SenderTrack& track, const Bsm& bsm, const Claim& claim, bool is_reread = false);

}  // namespace v2vouch
