// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/intake/accuracy_watch.h"

#include <algorithm>
#include <cmath>

namespace v2vouch {

bool AccuracyWatch::IsBadNow(Timestamp stamp, std::optional<double> reported_m, double believed_m) {
  if (!reported_m) return false;
  const double dt_s = usual_m_ ? std::max(0.0, ToSeconds(stamp - last_)) : 0.0;
  const double usual_m = usual_m_.value_or(*reported_m);
  is_improving_ = *reported_m < kBetter * usual_m && (is_improving_ || usual_m > believed_m);
  usual_m_ = std::min(*reported_m, usual_m * std::exp2(dt_s / kDoubling_s));
  last_ = stamp;
  return is_improving_ || *reported_m > std::max(believed_m, kWorse * *usual_m_);
}

}  // namespace v2vouch
