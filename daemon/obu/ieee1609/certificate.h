// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {

using HashedId8 = std::array<std::uint8_t, 8>;  ///< Last eight bytes of a certificate's SHA-256.

/// EccP256CurvePoint as it came.
struct CurvePoint {
  enum class Form : std::uint8_t { kNone, kXOnly, kEven, kOdd, kUncompressed };
  Form form = Form::kNone;
  Bytes x;  ///< 32 bytes.
  Bytes y;  ///< 32 bytes, uncompressed only.
};
CurvePoint ReadCurvePoint(ByteReader& reader);

struct EcdsaSignature {
  bool is_p256 = false;  ///< Others are passed over: r and s are empty then.
  CurvePoint r;
  Bytes s;
};
EcdsaSignature ReadSignature(ByteReader& reader);

/// Applications (provider service identifiers); those beyond the sixteenth are not kept.
class PsidList {
 public:
  void Add(std::uint32_t psid) {
    if (count_ < psids_.size()) psids_[count_++] = psid;
  }
  [[nodiscard]] bool Has(std::uint32_t psid) const {
    return std::ranges::find(all(), psid) != all().end();
  }
  [[nodiscard]] std::span<const std::uint32_t> all() const {
    return std::span(psids_).first(count_);
  }

 private:
  std::array<std::uint32_t, 16> psids_{};
  std::size_t count_ = 0;
};

/// Certificate of IEEE 1609.2-2016/2022 (ETSI TS 103 097 has a subset). Points into the datagram.
struct Certificate {
  enum class Issuer : std::uint8_t { kDigest, kSelf };

  Bytes whole;         ///< All its bytes.
  Bytes to_be_signed;  ///< ToBeSignedCertificate.
  bool is_implicit = false;
  Issuer issuer = Issuer::kDigest;
  HashedId8 issuer_digest{};
  std::uint8_t hash_algorithm = 0;  ///< Of the issuer's digest: 0 = SHA-256.
  std::uint32_t valid_from_s = 0;   ///< Seconds since 2004, leap seconds included.
  std::uint64_t valid_for_us = 0;
  PsidList psids;          ///< Applications that it may sign for.
  bool may_issue = false;  ///< Has certIssuePermissions.
  bool is_key_p256 = false;
  CurvePoint key;  ///< Verification key, or reconstruction value (implicit).
  bool has_signature = false;
  EcdsaSignature signature;
  bool has_canonical_form = true;  ///< Its bytes are those that are hashed (6.4.3): no uncompressed
                                   ///< point, signature r x-only.
};
Fault ReadCertificate(ByteReader& reader, Certificate& certificate);

}  // namespace v2vouch::obu
