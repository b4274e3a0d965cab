// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/message_frame.h"

#include <algorithm>

#include "daemon/obu/octets/bit_writer.h"

namespace v2vouch::obu {

Fault ReadMessageFrame(std::span<const std::uint8_t> bytes, MessageFrame& frame) {
  if (bytes.empty()) return {FaultKind::kEmpty, "MessageFrame"};
  BitReader reader(bytes);
  frame.has_extensions = reader.Flag();
  frame.message_id = static_cast<int>(reader.Bits(15));
  const std::size_t size = reader.Length("MessageFrame");
  if (!reader.ok()) return {reader.fault().kind, "MessageFrame"};
  const std::size_t start = reader.position() / 8;
  if (size > bytes.size() - start) return {FaultKind::kTruncated, "MessageFrame"};
  frame.value = bytes.subspan(start, size);
  frame.trailing = bytes.size() - start - size;
  return {};
}

Fault ReadBsm(const MessageFrame& frame, Bsm& bsm) {
  if (frame.message_id != kBsmMessageId) {
    return {FaultKind::kNotBsm, "messageId", frame.message_id};
  }
  const Fault fault = ReadBsm(frame.value, bsm);
  bsm.has_frame_extensions = frame.has_extensions;
  return fault;
}

Fault ReadBsmFrame(std::span<const std::uint8_t> bytes, Bsm& bsm) {
  MessageFrame frame;
  if (const Fault fault = ReadMessageFrame(bytes, frame)) return fault;
  return ReadBsm(frame, bsm);
}

std::string_view MessageName(int message_id) {
  switch (message_id) {
    case 18:
      return "MAP";
    case 19:
      return "SPAT";
    case 20:
      return "BSM";
    case 21:
      return "CSR";
    case 22:
      return "EVA";
    case 23:
      return "ICA";
    case 24:
      return "NMEA";
    case 25:
      return "PDM";
    case 26:
      return "PVD";
    case 27:
      return "RSA";
    case 28:
      return "RTCM";
    case 29:
      return "SRM";
    case 30:
      return "SSM";
    case 31:
      return "TIM";
    case 32:
      return "PSM";
    case 41:
      return "SDSM";
    case 240:
    case 241:
    case 242:
    case 243:
      return "CARMA mobility";
    default:
      return "";
  }
}

Fault WriteBsmFrame(const Bsm& bsm, std::span<std::uint8_t> out, std::size_t& size) {
  size = 0;
  // The value first, behind the longest header there can be; its length decides on the header.
  constexpr std::size_t kHeader = 4;
  if (out.size() < kHeader) return {FaultKind::kTooLong, "MessageFrame"};
  BitWriter value(out.subspan(kHeader));
  value.Flag(false);
  value.Flag(bsm.part_two_count > 0);
  value.Flag(bsm.regional_count > 0);
  bool is_first = true;
  for (const CoreField& field : CoreFields()) {
    const std::int64_t raw = bsm.core.*field.member;
    if (raw < field.low || raw > field.high) return {FaultKind::kOutOfRange, field.name, raw};
    value.Bits(static_cast<std::uint64_t>(raw - field.low), field.bits);
    if (is_first) value.Bits(bsm.core.id, 32);
    is_first = false;
  }
  const auto write_items = [&](std::span<const BsmItem> items, int count_bits, int id_bits) {
    if (items.empty()) return;
    value.Bits(items.size() - 1, count_bits);
    for (const BsmItem& item : items) {
      value.Bits(static_cast<std::uint64_t>(item.id), id_bits);
      value.Length(item.octets.bits / 8);
      value.Copy(item.octets);
    }
  };
  write_items(std::span(bsm.part_two).first(std::min(bsm.part_two_count, bsm.part_two.size())), 3,
              6);
  write_items(std::span(bsm.regional).first(std::min(bsm.regional_count, bsm.regional.size())), 2,
              8);
  value.Pad();
  if (!value.ok()) return {FaultKind::kTooLong, "MessageFrame"};

  const std::size_t octets = value.octets();
  BitWriter header(out.first(kHeader));
  header.Bits(static_cast<std::uint64_t>(kBsmMessageId), 16);
  header.Length(octets);
  if (!header.ok()) return {FaultKind::kTooLong, "MessageFrame"};
  std::copy_n(out.begin() + kHeader, octets,
              out.begin() + static_cast<std::ptrdiff_t>(header.octets()));
  size = header.octets() + octets;
  return {};
}

int Saturate(BsmCore& core) {
  int changed = 0;
  for (const CoreField& field : CoreFields()) {
    std::int32_t& raw = core.*field.member;
    // Where the last code means "unavailable", the one beside it is the largest figure.
    std::int32_t low = field.low;
    std::int32_t high = field.high;
    if (field.unavailable == raw) continue;
    if (field.unavailable == low && low < 0) ++low;
    if (field.unavailable == high && field.unit != 1.0) --high;
    const std::int32_t held = std::clamp(raw, low, high);
    changed += held != raw ? 1 : 0;
    raw = held;
  }
  return changed;
}

}  // namespace v2vouch::obu
