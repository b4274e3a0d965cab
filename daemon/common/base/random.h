// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace v2vouch {

/// Seeded generator whose distributions are ours: std::mt19937_64 is the same everywhere, the
/// std:: distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// An independent generator for one subject (a sensor, a vehicle), so that adding one subject
  /// does not change what the others draw.
  [[nodiscard]] static Random ForSubject(std::uint64_t seed, std::uint64_t subject);

  double Uniform();                         ///< In [0, 1), 53 bits.
  double Uniform(double low, double high);  ///< In [low, high).
  double Normal();                          ///< Mean 0, variance 1 (polar Box-Muller).
  double Normal(double mean, double sigma) { return mean + sigma * Normal(); }
  bool Bernoulli(double probability) { return Uniform() < probability; }
  int Poisson(double mean);  ///< By inversion; for means below about 50.
  std::uint64_t Bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
  bool has_spare_ = false;
  double spare_ = 0.0;
};

}  // namespace v2vouch
