// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "daemon/common/base/fnv1a.h"
#include "daemon/common/base/random.h"

namespace v2vouch::sim {

/// Outliers (SensorsSpec::outlier_share) are off by up to so many sigma.
inline constexpr double kOutlierSigmas = 30.0;

/// The generator of one subject: a name ("radar"), and numbers (which radar, which scan, which
/// vehicle). Every look at every vehicle has a generator of its own, so what is added to a scenario
/// changes nobody else's draws.
inline Random SubjectRandom(std::uint64_t seed, std::string_view name,
                            std::initializer_list<std::uint64_t> numbers) {
  // FNV-1a over the name, then the numbers; Random::ForSubject spreads the result.
  Fnv1a named;
  named.Add(name);
  std::uint64_t hash = named.value();
  for (const std::uint64_t number : numbers) {
    hash = (hash ^ number) * Fnv1a::kPrime;
    hash ^= hash >> 29;
    hash *= 0x9E3779B97F4A7C15ull;
  }
  return Random::ForSubject(seed, hash);
}

}  // namespace v2vouch::sim
