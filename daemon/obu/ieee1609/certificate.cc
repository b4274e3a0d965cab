// SPDX-License-Identifier: Apache-2.0
// Layouts: IEEE 1609.2-2016 clause 6.4, encoded in canonical OER.
#include "daemon/obu/ieee1609/certificate.h"

#include <algorithm>

namespace v2vouch::obu {
namespace {

constexpr std::size_t kMostElements = 64;  // Of any list; real ones have under ten.

void SkipCertificateId(ByteReader& reader) {
  switch (reader.Byte("certificate id")) {
    case 0x80: {  // linkageData: iCert, linkage value, perhaps a group's.
      const int preamble = reader.Byte("linkage");
      reader.Skip(2 + 9, "linkage");
      if ((preamble & 0x80) != 0) reader.Skip(4 + 9, "linkage");
      break;
    }
    case 0x81:  // name
    case 0x82:  // binaryId
      reader.Block("certificate id");
      break;
    case 0x83:  // none
      break;
    default:
      reader.Fail(FaultKind::kUnsupported, "certificate id");
  }
}

std::uint64_t DurationMicros(ByteReader& reader) {
  constexpr std::uint64_t kSecond = 1000000;
  const int unit = reader.Byte("duration");
  const std::uint64_t count = reader.Big(2, "duration");
  switch (unit) {
    case 0x80:
      return count;
    case 0x81:
      return count * 1000;
    case 0x82:
      return count * kSecond;
    case 0x83:
      return count * 60 * kSecond;
    case 0x84:
      return count * 3600 * kSecond;
    case 0x85:
      return count * 60 * 3600 * kSecond;
    case 0x86:
      return count * 31556952 * kSecond;  // Years as the standard counts them.
    default:
      reader.Fail(FaultKind::kOutOfRange, "duration", unit);
  }
  return 0;
}

void SkipRegion(ByteReader& reader) {
  switch (reader.Byte("region")) {
    case 0x80:  // circular: centre, radius
      reader.Skip(8 + 2, "region");
      break;
    case 0x81:  // rectangular: two corners each
      reader.Skip(16 * reader.Quantity(kMostElements, "region"), "region");
      break;
    case 0x82:  // polygonal
      reader.Skip(8 * reader.Quantity(kMostElements, "region"), "region");
      break;
    case 0x83: {  // identified
      const std::size_t count = reader.Quantity(kMostElements, "region");
      for (std::size_t i = 0; i < count && reader.ok(); ++i) {
        const int kind = reader.Byte("region");
        reader.Skip(2, "country");
        if (kind == 0x81) {
          reader.Skip(reader.Quantity(255, "region"), "region");  // One byte each.
        } else if (kind == 0x82) {
          const std::size_t regions = reader.Quantity(kMostElements, "region");
          for (std::size_t k = 0; k < regions && reader.ok(); ++k) {
            reader.Skip(1, "region");
            reader.Skip(2 * reader.Quantity(255, "subregion"), "subregion");
          }
        } else if (kind != 0x80) {
          reader.Fail(FaultKind::kUnsupported, "region");
        }
      }
      break;
    }
    default:
      reader.Fail(FaultKind::kUnsupported, "region");
  }
}

std::uint32_t WholePsid(ByteReader& reader) {
  const std::size_t octets = reader.Length("PSID");
  if (octets < 1 || octets > 4) {
    reader.Fail(FaultKind::kBadLength, "PSID", static_cast<std::int64_t>(octets));
    return 0;
  }
  return static_cast<std::uint32_t>(reader.Big(octets, "PSID"));
}

void ReadAppPermissions(ByteReader& reader, Certificate& certificate) {
  const std::size_t count = reader.Quantity(kMostElements, "appPermissions");
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const int preamble = reader.Byte("appPermissions");
    const std::uint32_t psid = WholePsid(reader);
    certificate.psids.Add(psid);
    if ((preamble & 0x80) != 0) {
      reader.Skip(1, "ssp");
      reader.Block("ssp");
    }
  }
}

void SkipGroupPermissions(ByteReader& reader) {
  const std::size_t count = reader.Quantity(kMostElements, "group permissions");
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const int preamble = reader.Byte("group permissions");
    const int subject = reader.Byte("subjectPermissions");
    if (subject == 0x80) {
      const std::size_t ranges = reader.Quantity(kMostElements, "subjectPermissions");
      for (std::size_t k = 0; k < ranges && reader.ok(); ++k) {
        const int has_range = reader.Byte("sspRange");
        WholePsid(reader);
        if ((has_range & 0x80) == 0) continue;
        const int kind = reader.Byte("sspRange");
        if (kind == 0x80) {
          const std::size_t ssps = reader.Quantity(kMostElements, "sspRange");
          for (std::size_t n = 0; n < ssps && reader.ok(); ++n) reader.Block("sspRange");
        } else if (kind > 0x81) {
          reader.Block("sspRange");
        }
      }
    } else if (subject != 0x81) {
      reader.Fail(FaultKind::kUnsupported, "subjectPermissions");
    }
    if ((preamble & 0x80) != 0) reader.Block("minChainLength");
    if ((preamble & 0x40) != 0) reader.Block("chainLengthRange");
    if ((preamble & 0x20) != 0) reader.Block("eeType");
  }
}

void NoteForm(const CurvePoint& point, Certificate& certificate) {
  if (point.form == CurvePoint::Form::kUncompressed) certificate.has_canonical_form = false;
}

void ReadToBeSigned(ByteReader& reader, Certificate& certificate) {
  const int preamble = reader.Byte("toBeSigned");
  SkipCertificateId(reader);
  reader.Skip(3 + 2, "cracaId, crlSeries");
  certificate.valid_from_s = static_cast<std::uint32_t>(reader.Big(4, "validityPeriod"));
  certificate.valid_for_us = DurationMicros(reader);
  if ((preamble & 0x40) != 0) SkipRegion(reader);
  if ((preamble & 0x20) != 0) reader.Skip(1, "assuranceLevel");
  if ((preamble & 0x10) != 0) ReadAppPermissions(reader, certificate);
  if ((preamble & 0x08) != 0) SkipGroupPermissions(reader);
  if ((preamble & 0x04) != 0) SkipGroupPermissions(reader);
  certificate.may_issue = (preamble & 0x08) != 0;
  // canRequestRollover (0x02) is a NULL: no byte.
  if ((preamble & 0x01) != 0) {
    reader.Skip(1, "encryptionKey");
    if (reader.Byte("encryptionKey") > 0x81) reader.Fail(FaultKind::kUnsupported, "encryptionKey");
    NoteForm(ReadCurvePoint(reader), certificate);
  }
  const int indicator = reader.Byte("verifyKeyIndicator");
  if (indicator == 0x80) {
    const int curve = reader.Byte("verificationKey");
    certificate.is_key_p256 = curve == 0x80;
    if (curve <= 0x81) {
      certificate.key = ReadCurvePoint(reader);
    } else {
      reader.Block("verificationKey");
    }
  } else if (indicator == 0x81) {
    certificate.is_key_p256 = true;
    certificate.key = ReadCurvePoint(reader);
  } else {
    reader.Fail(FaultKind::kUnsupported, "verifyKeyIndicator", indicator);
  }
  NoteForm(certificate.key, certificate);
  if ((preamble & 0x80) != 0) reader.SkipExtensions("toBeSigned");
}

}  // namespace

CurvePoint ReadCurvePoint(ByteReader& reader) {
  CurvePoint point;
  const int form = reader.Byte("curve point");
  switch (form) {
    case 0x80:
      point.form = CurvePoint::Form::kXOnly;
      break;
    case 0x82:
      point.form = CurvePoint::Form::kEven;
      break;
    case 0x83:
      point.form = CurvePoint::Form::kOdd;
      break;
    case 0x84:
      point.form = CurvePoint::Form::kUncompressed;
      break;
    default:
      reader.Fail(FaultKind::kOutOfRange, "curve point", form);
      return point;
  }
  point.x = reader.Take(32, "curve point");
  if (form == 0x84) point.y = reader.Take(32, "curve point");
  return point;
}

EcdsaSignature ReadSignature(ByteReader& reader) {
  EcdsaSignature signature;
  const int kind = reader.Byte("signature");
  if (kind == 0x80 || kind == 0x81) {  // P-256, brainpoolP256r1: alike.
    signature.is_p256 = kind == 0x80;
    signature.r = ReadCurvePoint(reader);
    signature.s = reader.Take(32, "signature");
  } else if (kind > 0x81 && kind < 0xC0) {
    reader.Block("signature");
  } else {
    reader.Fail(FaultKind::kUnsupported, "signature", kind);
  }
  return signature;
}

Fault ReadCertificate(ByteReader& reader, Certificate& certificate) {
  const std::size_t start = reader.position();
  const int preamble = reader.Byte("certificate");
  const int version = reader.Byte("certificate");
  if (reader.ok() && version != 3) reader.Fail(FaultKind::kUnsupported, "certificate version");
  certificate.is_implicit = reader.Byte("certificate type") == 1;
  const int issuer = reader.Byte("issuer");
  if (issuer == 0x81) {
    certificate.issuer = Certificate::Issuer::kSelf;
    certificate.hash_algorithm = reader.Byte("issuer");
  } else if (issuer == 0x80 || (issuer > 0x81 && issuer < 0xC0)) {
    // 0x80 SHA-256; 0x82 SHA-384 is an addition and carries a length.
    certificate.hash_algorithm = issuer == 0x80 ? 0 : 1;
    const Bytes digest = issuer == 0x80 ? reader.Take(8, "issuer") : reader.Block("issuer");
    if (reader.ok() && digest.size() != 8) reader.Fail(FaultKind::kBadLength, "issuer");
    if (reader.ok()) std::ranges::copy(digest, certificate.issuer_digest.begin());
  } else {
    reader.Fail(FaultKind::kUnsupported, "issuer", issuer);
  }
  const std::size_t signed_from = reader.position();
  ReadToBeSigned(reader, certificate);
  certificate.to_be_signed = reader.Since(signed_from);
  certificate.has_signature = (preamble & 0x80) != 0;
  if (certificate.has_signature) {
    certificate.signature = ReadSignature(reader);
    const auto form = certificate.signature.r.form;
    if (form != CurvePoint::Form::kNone && form != CurvePoint::Form::kXOnly) {
      certificate.has_canonical_form = false;
    }
  }
  certificate.whole = reader.Since(start);
  return reader.fault();
}

}  // namespace v2vouch::obu
