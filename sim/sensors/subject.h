// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

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
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : name) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211ull;
  for (const std::uint64_t number : numbers) {
    hash = (hash ^ number) * 1099511628211ull;
    hash ^= hash >> 29;
    hash *= 0x9E3779B97F4A7C15ull;
  }
  return Random::ForSubject(seed, hash);
}

}  // namespace v2vouch::sim
