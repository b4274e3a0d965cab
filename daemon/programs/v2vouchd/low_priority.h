// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace v2vouch {

/// The calling thread, and those it starts from now on, step back behind all others where the
/// processor is short. For diagnostics.
inline void LowerThreadPriority() {
  constexpr int kNice = 10;
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

}  // namespace v2vouch
