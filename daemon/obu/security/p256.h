// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "daemon/obu/ieee1609/certificate.h"

struct evp_pkey_st;

namespace v2vouch::obu {

using Hash = std::array<std::uint8_t, 32>;

/// SHA-256 of the parts one after the other.
Hash Sha256Of(std::initializer_list<Bytes> parts);

/// A point of NIST P-256, uncompressed: 04, x, y. Never the point at infinity.
using Point = std::array<std::uint8_t, 65>;

/// The point itself: nullopt where there is none with that x, or only x is known.
std::optional<Point> Decompressed(const CurvePoint& point);

/// A key that ECDSA signatures are checked with.
class PublicKey {
 public:
  /// nullopt where the point is not on the curve.
  static std::optional<PublicKey> FromPoint(const Point& point);

  /// Whether (r, s) is this key's signature of `hash`. r: x of the signature's point.
  [[nodiscard]] bool Verifies(const Hash& hash, Bytes r, Bytes s) const;
  [[nodiscard]] const Point& point() const { return point_; }

 private:
  PublicKey() = default;
  std::shared_ptr<evp_pkey_st> key_;  // Shared: copies are never changed.
  Point point_{};
};

/// The keys under which (r, s) is a signature of `hash`: Q = r^-1 (s R - z G). One where R's y is
/// known, two where only its x is.
std::vector<Point> RecoveredKeys(const Hash& hash, const CurvePoint& r, Bytes s);

/// Key of an implicit certificate (SEC 4): Q = e P + Q_issuer, e = hash shifted right by one bit.
std::optional<Point> ReconstructedKey(const Hash& hash, const CurvePoint& reconstruction,
                                      const Point& issuer);

}  // namespace v2vouch::obu
