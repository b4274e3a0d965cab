// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/security/p256.h"

#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/ec.h>
#include <openssl/ecdsa.h>
#include <openssl/evp.h>
#include <openssl/obj_mac.h>

#include <algorithm>

#include "daemon/common/base/sha256.h"

namespace v2vouch::obu {
namespace {

struct Free {
  void operator()(BIGNUM* x) const { BN_free(x); }
  void operator()(BN_CTX* x) const { BN_CTX_free(x); }
  void operator()(EC_GROUP* x) const { EC_GROUP_free(x); }
  void operator()(EC_POINT* x) const { EC_POINT_free(x); }
  void operator()(EVP_PKEY_CTX* x) const { EVP_PKEY_CTX_free(x); }
  void operator()(ECDSA_SIG* x) const { ECDSA_SIG_free(x); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

// The curve and room to calculate in. One per thread: neither is safe to share.
struct Curve {
  Owned<EC_GROUP> group{EC_GROUP_new_by_curve_name(NID_X9_62_prime256v1)};
  Owned<BN_CTX> room{BN_CTX_new()};

  [[nodiscard]] const BIGNUM* order() const { return EC_GROUP_get0_order(group.get()); }
};
Curve& TheCurve() {
  static thread_local Curve curve;
  return curve;
}

Owned<BIGNUM> Number(Bytes bytes) {
  return Owned<BIGNUM>(BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr));
}

std::optional<Point> Octets(const EC_POINT* point) {
  Curve& curve = TheCurve();
  Point octets{};
  const std::size_t size =
      EC_POINT_point2oct(curve.group.get(), point, POINT_CONVERSION_UNCOMPRESSED, octets.data(),
                         octets.size(), curve.room.get());
  if (size != octets.size()) return std::nullopt;  // Infinity is one octet.
  return octets;
}

// From 02/03 and x, or 04, x, y. Checks that the point is on the curve.
Owned<EC_POINT> PointOf(Bytes octets) {
  Curve& curve = TheCurve();
  Owned<EC_POINT> point(EC_POINT_new(curve.group.get()));
  if (EC_POINT_oct2point(curve.group.get(), point.get(), octets.data(), octets.size(),
                         curve.room.get()) != 1) {
    return nullptr;
  }
  return point;
}

Owned<EC_POINT> PointOf(const CurvePoint& point) {
  if (point.x.size() != 32) return nullptr;
  Point octets{};
  std::ranges::copy(point.x, octets.begin() + 1);
  switch (point.form) {
    case CurvePoint::Form::kEven:
    case CurvePoint::Form::kOdd:
      octets[0] = point.form == CurvePoint::Form::kEven ? 2 : 3;
      return PointOf(Bytes(octets).first(33));
    case CurvePoint::Form::kUncompressed:
      if (point.y.size() != 32) return nullptr;
      octets[0] = 4;
      std::ranges::copy(point.y, octets.begin() + 33);
      return PointOf(Bytes(octets));
    default:
      return nullptr;
  }
}

// Q = r^-1 (s R - z G).
std::optional<Point> Recovered(const Hash& hash, const EC_POINT* big_r, Bytes r, Bytes s) {
  Curve& curve = TheCurve();
  BN_CTX* const room = curve.room.get();
  const Owned<BIGNUM> z = Number(hash);
  const Owned<BIGNUM> r_number = Number(r);
  const Owned<BIGNUM> s_number = Number(s);
  if (BN_is_zero(r_number.get()) || BN_is_zero(s_number.get()) ||
      BN_cmp(r_number.get(), curve.order()) >= 0 || BN_cmp(s_number.get(), curve.order()) >= 0) {
    return std::nullopt;
  }
  const Owned<BIGNUM> inverse(BN_mod_inverse(nullptr, r_number.get(), curve.order(), room));
  if (!inverse) return std::nullopt;
  Owned<BIGNUM> of_g(BN_new());
  Owned<BIGNUM> of_r(BN_new());
  BN_mod_mul(of_r.get(), s_number.get(), inverse.get(), curve.order(), room);
  BN_mod_mul(of_g.get(), z.get(), inverse.get(), curve.order(), room);
  BN_mod_sub(of_g.get(), curve.order(), of_g.get(), curve.order(), room);
  Owned<EC_POINT> key(EC_POINT_new(curve.group.get()));
  if (EC_POINT_mul(curve.group.get(), key.get(), of_g.get(), big_r, of_r.get(), room) != 1) {
    return std::nullopt;
  }
  return Octets(key.get());
}

}  // namespace

Hash Sha256Of(std::initializer_list<Bytes> parts) {
  Sha256 sum;
  for (const Bytes part : parts) sum.Add(part);
  return sum.Digest();
}

std::optional<Point> Decompressed(const CurvePoint& point) {
  const Owned<EC_POINT> on_curve = PointOf(point);
  return on_curve ? Octets(on_curve.get()) : std::nullopt;
}

std::optional<PublicKey> PublicKey::FromPoint(const Point& point) {
  if (!PointOf(Bytes(point))) return std::nullopt;
  char curve[] = "P-256";
  Point octets = point;
  OSSL_PARAM parameters[] = {
      OSSL_PARAM_construct_utf8_string(OSSL_PKEY_PARAM_GROUP_NAME, curve, 0),
      OSSL_PARAM_construct_octet_string(OSSL_PKEY_PARAM_PUB_KEY, octets.data(), octets.size()),
      OSSL_PARAM_construct_end()};
  const Owned<EVP_PKEY_CTX> context(EVP_PKEY_CTX_new_from_name(nullptr, "EC", nullptr));
  EVP_PKEY* made = nullptr;
  if (!context || EVP_PKEY_fromdata_init(context.get()) != 1 ||
      EVP_PKEY_fromdata(context.get(), &made, EVP_PKEY_PUBLIC_KEY, parameters) != 1) {
    return std::nullopt;
  }
  PublicKey key;
  key.key_ = std::shared_ptr<EVP_PKEY>(made, EVP_PKEY_free);
  key.point_ = point;
  return key;
}

bool PublicKey::Verifies(const Hash& hash, Bytes r, Bytes s) const {
  if (r.size() != 32 || s.size() != 32) return false;
  const Owned<ECDSA_SIG> signature(ECDSA_SIG_new());
  if (ECDSA_SIG_set0(signature.get(), Number(r).release(), Number(s).release()) != 1) return false;
  std::array<std::uint8_t, 80> der{};  // Two numbers of 33 octets at most, with their headers.
  std::uint8_t* end = der.data();
  const int size = i2d_ECDSA_SIG(signature.get(), nullptr);
  if (size <= 0 || static_cast<std::size_t>(size) > der.size()) return false;
  i2d_ECDSA_SIG(signature.get(), &end);
  const Owned<EVP_PKEY_CTX> context(EVP_PKEY_CTX_new_from_pkey(nullptr, key_.get(), nullptr));
  return context && EVP_PKEY_verify_init(context.get()) == 1 &&
         EVP_PKEY_verify(context.get(), der.data(), static_cast<std::size_t>(size), hash.data(),
                         hash.size()) == 1;
}

std::vector<Point> RecoveredKeys(const Hash& hash, const CurvePoint& r, Bytes s) {
  std::vector<Point> keys;
  if (r.x.size() != 32 || s.size() != 32) return keys;
  const auto add = [&](const CurvePoint& point) {
    const Owned<EC_POINT> big_r = PointOf(point);
    if (!big_r) return;
    if (const auto key = Recovered(hash, big_r.get(), r.x, s)) keys.push_back(*key);
  };
  if (r.form != CurvePoint::Form::kXOnly) {
    add(r);
  } else {
    CurvePoint guess = r;
    for (const auto form : {CurvePoint::Form::kEven, CurvePoint::Form::kOdd}) {
      guess.form = form;
      add(guess);
    }
  }
  return keys;
}

std::optional<Point> ReconstructedKey(const Hash& hash, const CurvePoint& reconstruction,
                                      const Point& issuer) {
  Curve& curve = TheCurve();
  const Owned<EC_POINT> p = PointOf(reconstruction);
  const Owned<EC_POINT> of_issuer = PointOf(Bytes(issuer));
  if (!p || !of_issuer) return std::nullopt;
  const Owned<BIGNUM> e = Number(hash);
  BN_rshift1(e.get(), e.get());
  Owned<EC_POINT> key(EC_POINT_new(curve.group.get()));
  if (EC_POINT_mul(curve.group.get(), key.get(), nullptr, p.get(), e.get(), curve.room.get()) !=
          1 ||
      EC_POINT_add(curve.group.get(), key.get(), key.get(), of_issuer.get(), curve.room.get()) !=
          1) {
    return std::nullopt;
  }
  return Octets(key.get());
}

}  // namespace v2vouch::obu
