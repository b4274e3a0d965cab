// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/gateway/receptions.h"

namespace v2vouch::obu {

Receptions::Heard Receptions::Of(const Datagram& datagram, std::int64_t rx_utime,
                                 std::int64_t seq) {
  Heard heard;
  heard.reception.rx_utime = rx_utime;
  heard.reception.seq = seq;
  if (datagram.dot2) {
    heard.judgement = verifier_.Judge(*datagram.dot2, rx_utime);
    heard.reception.digest = heard.judgement.digest;
    heard.reception.signature_state = heard.judgement.signature_state();
  } else if (datagram.cohda) {
    heard.reception.digest = datagram.cohda->certificate_digest;
  }
  if (datagram.cam) heard.reception.cam_count = cam_counts_.CountOf(*datagram.cam);
  return heard;
}

}  // namespace v2vouch::obu
