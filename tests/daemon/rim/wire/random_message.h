// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "daemon/rim/wire/layout.h"

namespace v2vouch::wire {

/// Encodes random but well-formed values of any type, from its layout alone: numbers are random
/// bits, arrays hold 0..4 elements, strings 0..12 letters.
class RandomMessage {
 public:
  explicit RandomMessage(std::uint64_t seed) : rng_(seed) {}

  std::vector<std::uint8_t> Make(const Layout& layout, std::int64_t fingerprint) {
    bytes_.clear();
    Put(static_cast<std::uint64_t>(fingerprint), 8);
    Struct(layout);
    return bytes_;
  }

  std::mt19937_64& rng() { return rng_; }

 private:
  void Put(std::uint64_t value, int bytes) {
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  }

  void Struct(const Layout& layout) {
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      const Field& field = layout.fields[i];
      if (i + 1 < layout.fields.size() && layout.fields[i + 1].max_count > 0) {
        count_ = static_cast<int>(rng_() % 5);
        Put(static_cast<std::uint64_t>(count_), 4);
        continue;
      }
      const int elements = field.max_count > 0 ? count_ : field.fixed;
      for (int n = 0; n < elements; ++n) Element(field);
    }
  }

  void Element(const Field& field) {
    if (field.kind == Kind::kStruct) {
      Struct(*field.type);
    } else if (field.kind == Kind::kString) {
      const auto length = rng_() % 13;
      Put(length + 1, 4);
      for (std::uint64_t n = 0; n < length; ++n) Put('A' + rng_() % 26, 1);
      Put(0, 1);
    } else {
      Put(rng_(), static_cast<int>(SizeOf(field.kind)));
    }
  }

  std::mt19937_64 rng_;
  std::vector<std::uint8_t> bytes_;
  int count_ = 0;
};

}  // namespace v2vouch::wire
