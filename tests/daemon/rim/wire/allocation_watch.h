// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>

namespace v2vouch {

/// The largest single allocation by operator new since it was set to 0. Link allocation_watch.cc.
extern std::atomic<std::size_t> largest_allocation;

}  // namespace v2vouch
