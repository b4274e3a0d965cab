// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);

}  // namespace v2vouch

/// Our own mistake that no input can cause: stop with file and line. Never for input.
#define V2VOUCH_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::v2vouch::CheckFailed(#condition, __FILE__, __LINE__))
