// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/base/time.h"
#include "daemon/data/input.h"
#include "daemon/data/outputs.h"
#include "daemon/trust/sender_trust.h"

namespace v2vouch {

/// A verdict as the report that leaves the car, with the figure that broke its limit as evidence.
MisbehaviorReport ReportOf(const SenderTrust::Judgement& judgement, SenderId sender,
                           const CertificateDigest& certificate, Timestamp stamp);

}  // namespace v2vouch
