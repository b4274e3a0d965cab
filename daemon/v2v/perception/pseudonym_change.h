// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/v2v/perception/v2v_view.h"

namespace v2vouch {

/// The vehicle whose sender has just spoken again under the id that another id was taken to
/// continue: then there was no change of pseudonym, and the other id is an intruder. Null: none.
PriorityVehicle* FindContested(PriorityList& list, SenderId sender, Timestamp now,
                               const IdentityChangeConfig& config);

/// An honest change of pseudonym: a new id goes on where an old one has just fallen silent. An
/// id that was heard before that is another sender. Counts the newcomer's claims that fit one
/// vehicle alone.
/// @return the vehicle that the sender continues, after IdentityChangeConfig::messages; null: none.
PriorityVehicle* FindContinued(PriorityList& list, SenderRecord& record,
                               const ClaimInOdometry& here, const PriorityConfig& config);

}  // namespace v2vouch
