// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace v2vouch::obu {

/// Why a datagram, a layer of one or a part of a message could not be read or used.
enum class FaultKind : std::uint8_t {
  kNone,
  kEmpty,           ///< No byte at all.
  kTruncated,       ///< Ends before the layout does.
  kTooLong,         ///< Above the cap for one datagram.
  kTrailingBytes,   ///< Goes on after the layout ended.
  kBadLength,       ///< A length that the layout does not allow.
  kFragmented,      ///< A UPER length in pieces: no message of this size needs one.
  kOutOfRange,      ///< A value the standard does not define.
  kUnknownFraming,  ///< The first bytes belong to no layer known here.
  kUnsupported,     ///< Known, and not read here: its name is in `where`.
  kNestedTooDeep,   ///< An envelope within an envelope.
  kEncrypted,
  kNotBsm,           ///< Another J2735 message; `value` is its id.
  kNotCam,           ///< Another ETSI message; `value` is its port or message id.
  kNotVehicle,       ///< Sent by something that does not drive; `value` is its station type.
  kWrongPsid,        ///< Envelope and content are of different applications.
  kOwnTransmission,  ///< The unit tells what it sent itself.
  kNotV2x,           ///< A packet of another protocol.
  kIpFragment,       ///< One piece of a fragmented IP packet.
  kBadText,          ///< Neither hex nor a message file of an RSU.
  kCount
};

/// Snake-case name as printed, e.g. "out_of_range".
std::string_view FaultName(FaultKind kind);

/// What is wrong, where, and with which figure.
struct Fault {
  FaultKind kind = FaultKind::kNone;
  std::string_view where;  ///< Layer or field; points at a literal.
  std::int64_t value = 0;

  explicit operator bool() const { return kind != FaultKind::kNone; }
  friend bool operator==(const Fault&, const Fault&) = default;
};

/// "out_of_range: heading (28801)"; "" without a fault.
std::string FaultText(const Fault& fault);

}  // namespace v2vouch::obu
