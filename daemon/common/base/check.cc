// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace v2vouch {

void CheckFailed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: check failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace v2vouch
