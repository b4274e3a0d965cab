// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/obu/j2735/bsm.h"

namespace v2vouch::obu {

/// SAE J2735 MessageFrame: extension bit, messageId (15 bits), value as an open type. The layout is
/// the same in the editions of 2016 to 2024.
struct MessageFrame {
  int message_id = 0;
  bool has_extensions = false;
  std::span<const std::uint8_t> value;
  std::size_t trailing = 0;  ///< Bytes behind the value; extensions, where there are any.
};

/// Reads the frame that begins at the first byte. What lies behind it is told, not judged.
Fault ReadMessageFrame(std::span<const std::uint8_t> bytes, MessageFrame& frame);

/// The BSM of a frame: kNotBsm with the id for every other message.
Fault ReadBsm(const MessageFrame& frame, Bsm& bsm);

/// Frame and BSM in one.
Fault ReadBsmFrame(std::span<const std::uint8_t> bytes, Bsm& bsm);

/// "MAP", "SPAT", ...; "" for an id that no edition names.
std::string_view MessageName(int message_id);

/// Writes `bsm` as a MessageFrame: the core, and the items of Part II and the regional ones as they
/// are; extensions are left out.
/// @param size octets written.
/// @return kOutOfRange with the field where the core has a value that the standard does not define;
///         kTooLong where `out` is too small.
Fault WriteBsmFrame(const Bsm& bsm, std::span<std::uint8_t> out, std::size_t& size);

/// Brings every value of the core into its range, and counts what had to be changed: a figure too
/// large takes the largest value that means "this much or more".
int Saturate(BsmCore& core);

}  // namespace v2vouch::obu
