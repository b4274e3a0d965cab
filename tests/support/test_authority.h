// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tests/support/obu_samples.h"

namespace v2vouch {

/// A private key of P-256 for tests, made of a name: the same every time.
struct TestKey {
  Octets secret;      ///< 32 bytes.
  Octets compressed;  ///< 33 bytes, 02 or 03 first.
};
TestKey KeyOf(const std::string& name);

/// ECDSA signature of a hash; the secret number is made of key and hash.
struct TestSignature {
  Octets r_point;  ///< 33 bytes, compressed.
  Octets s;
};
TestSignature Sign(const TestKey& key, const Octets& hash);

struct TestCertificate {
  Octets bytes;
  TestKey key;
};
struct TestCertificateOptions {
  std::string name = "subject";
  std::uint32_t valid_from_s = 600000000;
  std::uint32_t valid_hours = 50000;
  std::uint32_t psid = 0x20;
  bool may_issue = false;
};
/// Signs itself.
TestCertificate RootCertificate(const TestCertificateOptions& options);
/// Explicit, signed by `issuer`.
TestCertificate ExplicitCertificate(const TestCertificate& issuer,
                                    const TestCertificateOptions& options);
/// Implicit (SEC 4), made by `issuer`.
TestCertificate ImplicitCertificate(const TestCertificate& issuer,
                                    const TestCertificateOptions& options);

Octets Sha256(const Octets& bytes);
Octets TestDigest(const TestCertificate& certificate);  ///< HashedId8.

/// Envelope round `payload`, truly signed.
Octets SignedBy(const TestCertificate& signer, const Octets& payload, std::uint64_t generation_us,
                bool with_certificate, std::uint32_t psid = 0x20, bool x_only = false);

}  // namespace v2vouch
