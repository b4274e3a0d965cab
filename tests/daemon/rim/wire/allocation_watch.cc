// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/rim/wire/allocation_watch.h"

#include <cstdlib>
#include <new>

namespace v2vouch {

std::atomic<std::size_t> largest_allocation{0};

}  // namespace v2vouch

void* operator new(std::size_t size) {
  std::size_t seen = v2vouch::largest_allocation.load();
  while (size > seen && !v2vouch::largest_allocation.compare_exchange_weak(seen, size)) {
  }
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
