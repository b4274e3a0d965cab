// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "daemon/obu/ieee1609/certificate.h"

namespace v2vouch::obu {

/// Ieee1609Dot2Data of IEEE 1609.2-2016/2022: the envelope round a message. Points into the
/// datagram.
struct Dot2Data {
  enum class Content : std::uint8_t { kUnsecured, kSigned, kEncrypted, kRequest };
  enum class Signer : std::uint8_t { kNone, kDigest, kCertificate, kSelf };

  Content content = Content::kUnsecured;
  Bytes payload;
  std::size_t trailing = 0;  ///< Bytes behind the envelope.

  // Signed data only.
  std::uint8_t hash_algorithm = 0;  ///< 0 = SHA-256.
  Bytes to_be_signed;               ///< ToBeSignedData, whose hash is signed.
  std::uint32_t psid = 0;
  std::optional<std::uint64_t> generation_us;  ///< Since 2004, leap seconds included.
  std::optional<std::uint64_t> expiry_us;
  Signer signer = Signer::kNone;
  HashedId8 signer_digest{};               ///< Where the signer is a digest.
  std::optional<Certificate> certificate;  ///< Where the signer is a certificate.
  EcdsaSignature signature;
  /// What of the header, the signer or the signature could not be read. The payload is good all the
  /// same, the signature is not known then.
  Fault security_fault;
};

/// Whether `bytes` can begin an envelope that ReadDot2() reads.
bool LooksLikeDot2(Bytes bytes);

/// kEncrypted for data that are encrypted; kUnsupported for certificate requests and for payloads
/// given by their hash only.
Fault ReadDot2(Bytes bytes, Dot2Data& data);

}  // namespace v2vouch::obu
