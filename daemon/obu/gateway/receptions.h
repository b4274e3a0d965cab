// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/message/bsm_message.h"
#include "daemon/obu/security/verifier.h"

namespace v2vouch::obu {

/// Finds out what goes into a message beside its core: signature judged, certificate's digest, a
/// CAM counted. One stream of messages, in its order.
class Receptions {
 public:
  Receptions(VerifierConfig config, TrustAnchors anchors) : verifier_(config, std::move(anchors)) {}

  struct Heard {
    Reception reception;
    Judgement judgement;
  };
  Heard Of(const Datagram& datagram, std::int64_t rx_utime, std::int64_t seq);

  [[nodiscard]] std::size_t certificates() const { return verifier_.certificates(); }

 private:
  Verifier verifier_;
  CamCounts cam_counts_;
};

}  // namespace v2vouch::obu
