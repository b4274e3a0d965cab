// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_authority.h"

#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/obj_mac.h>
#include <openssl/sha.h>

#include <memory>

#include "tests/support/obu_wrap.h"

namespace v2vouch {
namespace {

struct Free {
  void operator()(BIGNUM* x) const { BN_free(x); }
  void operator()(BN_CTX* x) const { BN_CTX_free(x); }
  void operator()(EC_GROUP* x) const { EC_GROUP_free(x); }
  void operator()(EC_POINT* x) const { EC_POINT_free(x); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

EC_GROUP* Group() {
  static const Owned<EC_GROUP> group(EC_GROUP_new_by_curve_name(NID_X9_62_prime256v1));
  return group.get();
}
BN_CTX* Room() {
  static const Owned<BN_CTX> room(BN_CTX_new());
  return room.get();
}
const BIGNUM* Order() { return EC_GROUP_get0_order(Group()); }

Owned<BIGNUM> Number(const Octets& bytes) {
  return Owned<BIGNUM>(BN_bin2bn(bytes.data(), static_cast<int>(bytes.size()), nullptr));
}
Octets Bytes32(const BIGNUM* number) {
  Octets bytes(32);
  BN_bn2binpad(number, bytes.data(), 32);
  return bytes;
}
Octets Compressed(const EC_POINT* point) {
  Octets bytes(33);
  EC_POINT_point2oct(Group(), point, POINT_CONVERSION_COMPRESSED, bytes.data(), 33, Room());
  return bytes;
}
Owned<EC_POINT> TimesG(const BIGNUM* number) {
  Owned<EC_POINT> point(EC_POINT_new(Group()));
  EC_POINT_mul(Group(), point.get(), number, nullptr, nullptr, Room());
  return point;
}
TestKey KeyOfSecret(const BIGNUM* secret) {
  return {Bytes32(secret), Compressed(TimesG(secret).get())};
}
// A number below the order, made of text.
Owned<BIGNUM> NumberOf(const std::string& text) {
  Owned<BIGNUM> number = Number(Sha256(Octets(text.begin(), text.end())));
  BN_mod(number.get(), number.get(), Order(), Room());
  return number;
}

// ToBeSignedCertificate up to the key indicator.
Octets ToBeSigned(const TestCertificateOptions& options) {
  Octets out = {static_cast<std::uint8_t>(options.may_issue ? 0x18 : 0x10), 0x81};
  Append(out, options.name.size(), 1);
  out = Joined(out, Octets(options.name.begin(), options.name.end()));
  Append(out, 0x0000000001, 5);  // cracaId, crlSeries.
  Append(out, options.valid_from_s, 4);
  Append(out, 0x84, 1);  // Hours.
  Append(out, options.valid_hours, 2);
  out = Joined(out, {0x01, 0x01, 0x00, 0x01});
  Append(out, options.psid, 1);
  if (options.may_issue) {
    // One group: all applications, chain length 2.
    out = Joined(out, {0x01, 0x01, 0x80, 0x81, 0x01, 0x02});
  }
  return out;
}

Octets Head(bool has_signature, bool is_implicit, const Octets& issuer) {
  return Joined({static_cast<std::uint8_t>(has_signature ? 0x80 : 0x00), 0x03,
                 static_cast<std::uint8_t>(is_implicit ? 0x01 : 0x00)},
                issuer);
}

TestCertificate Explicit(const TestCertificate* issuer, const TestCertificateOptions& options) {
  TestCertificate made;
  made.key = KeyOf(options.name);
  Octets to_be_signed = Joined(ToBeSigned(options), {0x80, 0x80});
  Octets point = made.key.compressed;
  point[0] = static_cast<std::uint8_t>(0x80 + point[0]);
  to_be_signed = Joined(to_be_signed, point);
  const Octets issuer_field =
      issuer == nullptr ? Octets{0x81, 0x00} : Joined({0x80}, TestDigest(*issuer));
  const Octets issuer_hash = Sha256(issuer == nullptr ? Octets{} : issuer->bytes);
  const TestSignature signature = Sign(issuer == nullptr ? made.key : issuer->key,
                                       Sha256(Joined(Sha256(to_be_signed), issuer_hash)));
  made.bytes = Joined(Head(true, false, issuer_field), to_be_signed);
  made.bytes = Joined(made.bytes, {0x80, 0x80});
  made.bytes = Joined(made.bytes, Octets(signature.r_point.begin() + 1, signature.r_point.end()));
  made.bytes = Joined(made.bytes, signature.s);
  return made;
}

}  // namespace

Octets Sha256(const Octets& bytes) {
  Octets hash(32);
  SHA256(bytes.data(), bytes.size(), hash.data());
  return hash;
}

TestKey KeyOf(const std::string& name) { return KeyOfSecret(NumberOf("key of " + name).get()); }

TestSignature Sign(const TestKey& key, const Octets& hash) {
  const Owned<BIGNUM> k = NumberOf("nonce" + HexText(key.secret) + HexText(hash));
  const Owned<EC_POINT> point = TimesG(k.get());
  TestSignature signature;
  signature.r_point = Compressed(point.get());
  const Owned<BIGNUM> r = Number(Octets(signature.r_point.begin() + 1, signature.r_point.end()));
  const Owned<BIGNUM> d = Number(key.secret);
  const Owned<BIGNUM> z = Number(hash);
  const Owned<BIGNUM> s(BN_new());
  BN_mod_mul(s.get(), r.get(), d.get(), Order(), Room());
  BN_mod_add(s.get(), s.get(), z.get(), Order(), Room());
  const Owned<BIGNUM> inverse(BN_mod_inverse(nullptr, k.get(), Order(), Room()));
  BN_mod_mul(s.get(), s.get(), inverse.get(), Order(), Room());
  signature.s = Bytes32(s.get());
  return signature;
}

TestCertificate RootCertificate(const TestCertificateOptions& options) {
  return Explicit(nullptr, options);
}

TestCertificate ExplicitCertificate(const TestCertificate& issuer,
                                    const TestCertificateOptions& options) {
  return Explicit(&issuer, options);
}

TestCertificate ImplicitCertificate(const TestCertificate& issuer,
                                    const TestCertificateOptions& options) {
  const Owned<BIGNUM> mine = NumberOf("request of " + options.name);
  const Owned<BIGNUM> theirs = NumberOf("reply to " + options.name);
  const Owned<BIGNUM> sum(BN_new());
  BN_mod_add(sum.get(), mine.get(), theirs.get(), Order(), Room());
  Octets point = Compressed(TimesG(sum.get()).get());
  point[0] = static_cast<std::uint8_t>(0x80 + point[0]);
  const Octets to_be_signed = Joined(Joined(ToBeSigned(options), {0x81}), point);
  const Owned<BIGNUM> e = Number(Sha256(Joined(Sha256(to_be_signed), Sha256(issuer.bytes))));
  BN_rshift1(e.get(), e.get());
  // Key of the holder: e (mine + theirs) + key of the issuer.
  const Owned<BIGNUM> secret(BN_new());
  BN_mod_mul(secret.get(), e.get(), sum.get(), Order(), Room());
  const Owned<BIGNUM> issuer_secret = Number(issuer.key.secret);
  BN_mod_add(secret.get(), secret.get(), issuer_secret.get(), Order(), Room());
  TestCertificate made;
  made.key = KeyOfSecret(secret.get());
  made.bytes = Joined(Head(false, true, Joined({0x80}, TestDigest(issuer))), to_be_signed);
  return made;
}

Octets TestDigest(const TestCertificate& certificate) {
  const Octets hash = Sha256(certificate.bytes);
  return Octets(hash.end() - 8, hash.end());
}

Octets SignedBy(const TestCertificate& signer, const Octets& payload, std::uint64_t generation_us,
                bool with_certificate, std::uint32_t psid, bool x_only) {
  Octets to_be_signed = Joined({0x40}, WrapUnsecured(payload));
  Append(to_be_signed, 0x40, 1);
  Append(to_be_signed, 0x0100 | psid, 2);
  Append(to_be_signed, generation_us, 8);
  const TestSignature signature =
      Sign(signer.key, Sha256(Joined(Sha256(to_be_signed), Sha256(signer.bytes))));
  Octets out = Joined({0x03, 0x81, 0x00}, to_be_signed);
  out = with_certificate ? Joined(Joined(out, {0x81, 0x01, 0x01}), signer.bytes)
                         : Joined(Joined(out, {0x80}), TestDigest(signer));
  Octets r = signature.r_point;
  r[0] = static_cast<std::uint8_t>(x_only ? 0x80 : 0x80 + r[0]);
  return Joined(Joined(Joined(out, {0x80}), r), signature.s);
}

}  // namespace v2vouch
