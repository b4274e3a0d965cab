// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/time.h"
#include "daemon/common/data/input.h"
#include "daemon/common/data/outputs.h"
#include "daemon/v2v/trust/sender_trust.h"

namespace v2vouch {

/// A verdict as the report that leaves the car, with the figure that broke its limit as evidence.
MisbehaviorReport ReportOf(const SenderTrust::Judgement& judgement, SenderId sender,
                           const CertificateDigest& certificate, Timestamp stamp);

}  // namespace v2vouch
