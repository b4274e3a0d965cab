// SPDX-License-Identifier: Apache-2.0
// Layouts: IEEE 1609.2-2016 clause 6.3, encoded in canonical OER.
#include "daemon/obu/ieee1609/dot2.h"

#include <algorithm>

namespace v2vouch::obu {
namespace {

constexpr int kVersion = 3;
constexpr int kUnsecured = 0x80;
constexpr int kSigned = 0x81;
constexpr int kEncrypted = 0x82;
constexpr int kRequest = 0x83;

void ReadHeader(ByteReader& reader, Dot2Data& data) {
  const int preamble = reader.Byte("header");
  const std::size_t octets = reader.Length("PSID");
  if (octets < 1 || octets > 4) reader.Fail(FaultKind::kBadLength, "PSID");
  data.psid = static_cast<std::uint32_t>(reader.Big(octets, "PSID"));
  if ((preamble & 0x40) != 0) {
    const std::uint64_t time = reader.Big(8, "generationTime");
    if (reader.ok()) data.generation_us = time;
  }
  if ((preamble & 0x20) != 0) {
    const std::uint64_t time = reader.Big(8, "expiryTime");
    if (reader.ok()) data.expiry_us = time;
  }
  if ((preamble & 0x10) != 0) reader.Skip(4 + 4 + 2, "generationLocation");
  if ((preamble & 0x08) != 0) reader.Skip(3, "p2pcdLearningRequest");
  if ((preamble & 0x04) != 0) reader.Skip(3 + 2, "missingCrlIdentifier");
  if ((preamble & 0x02) != 0) {
    if (reader.Byte("encryptionKey") != 0x80) reader.Fail(FaultKind::kUnsupported, "encryptionKey");
    reader.Skip(1, "encryptionKey");
    if (reader.Byte("encryptionKey") > 0x81) reader.Fail(FaultKind::kUnsupported, "encryptionKey");
    ReadCurvePoint(reader);
  }
  if ((preamble & 0x80) != 0) reader.SkipExtensions("header");
}

void ReadSigner(ByteReader& reader, Dot2Data& data) {
  const int kind = reader.Byte("signer");
  if (kind == 0x80) {
    data.signer = Dot2Data::Signer::kDigest;
    const Bytes digest = reader.Take(8, "signer");
    if (reader.ok()) std::ranges::copy(digest, data.signer_digest.begin());
  } else if (kind == 0x81) {
    data.signer = Dot2Data::Signer::kCertificate;
    // The signer's own comes first; the rest of a chain is passed over.
    const std::size_t count = reader.Quantity(8, "signer certificates");
    for (std::size_t i = 0; i < count && reader.ok(); ++i) {
      Certificate certificate;
      const Fault fault = ReadCertificate(reader, certificate);
      if (i == 0 && !fault) data.certificate = certificate;
    }
    if (count == 0) reader.Fail(FaultKind::kBadLength, "signer certificates");
  } else if (kind == 0x82) {
    data.signer = Dot2Data::Signer::kSelf;
  } else {
    reader.Fail(FaultKind::kUnsupported, "signer", kind);
  }
}

Fault ReadSigned(ByteReader& reader, Dot2Data& data) {
  data.hash_algorithm = reader.Byte("hashId");
  const std::size_t signed_from = reader.position();
  const int preamble = reader.Byte("payload");
  if (reader.ok() && (preamble & 0x40) == 0) {
    return {FaultKind::kUnsupported, "payload by hash"};
  }
  if (reader.ok() && reader.Byte("inner version") != kVersion) {
    return {FaultKind::kUnsupported, "1609.2 version"};
  }
  const int inner = reader.Byte("inner content");
  if (reader.ok() && inner != kUnsecured) {
    if (inner == kEncrypted) return {FaultKind::kEncrypted, "payload"};
    return {FaultKind::kNestedTooDeep, "payload"};
  }
  data.payload = reader.Block("payload");
  if ((preamble & 0x20) != 0) {  // A hash of outside data beside the payload.
    reader.Skip(1, "extDataHash");
    reader.Skip(32, "extDataHash");
  }
  if (!reader.ok()) return reader.fault();

  // From here on nothing costs the payload.
  ReadHeader(reader, data);
  data.to_be_signed = reader.Since(signed_from);
  ReadSigner(reader, data);
  data.signature = ReadSignature(reader);
  data.security_fault = reader.fault();
  if (!reader.ok()) data.certificate.reset();
  data.trailing = reader.ok() ? reader.left() : 0;
  return {};
}

}  // namespace

bool LooksLikeDot2(Bytes bytes) {
  const ByteReader reader(bytes);
  return reader.Peek() == kVersion && reader.Peek(1) >= kUnsecured && reader.Peek(1) <= kRequest;
}

Fault ReadDot2(Bytes bytes, Dot2Data& data) {
  ByteReader reader(bytes);
  const int version = reader.Byte("1609.2");
  const int content = reader.Byte("1609.2");
  if (!reader.ok()) return reader.fault();
  if (version != kVersion) return {FaultKind::kUnsupported, "1609.2 version", version};
  switch (content) {
    case kUnsecured:
      data.content = Dot2Data::Content::kUnsecured;
      data.payload = reader.Block("1609.2 unsecured data");
      data.trailing = reader.left();
      return reader.fault();
    case kSigned:
      data.content = Dot2Data::Content::kSigned;
      return ReadSigned(reader, data);
    case kEncrypted:
      data.content = Dot2Data::Content::kEncrypted;
      return {FaultKind::kEncrypted, "1609.2 data"};
    case kRequest:
      data.content = Dot2Data::Content::kRequest;
      return {FaultKind::kUnsupported, "certificate request"};
    default:
      return {FaultKind::kUnsupported, "1609.2 content", content};
  }
}

}  // namespace v2vouch::obu
