// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/bsm.h"

#include "daemon/obu/j2735/part_two.h"

namespace v2vouch::obu {
namespace {

// SAE J2735 (2016, 2020 and 2024 alike): constraints of the data elements of BSMcoreData.
constexpr std::array<CoreField, 24> kFields = {{
    {"msgCnt", &BsmCore::msg_count, 7, 0, 127},
    {"secMark", &BsmCore::sec_mark, 16, 0, 65535, 65535, 0.001, "s"},
    {"lat", &BsmCore::lat, 31, -900000000, 900000001, 900000001, 1e-7, "deg"},
    {"long_", &BsmCore::lon, 32, -1799999999, 1800000001, 1800000001, 1e-7, "deg"},
    {"elev", &BsmCore::elev, 16, -4096, 61439, -4096, 0.1, "m"},
    {"semiMajor", &BsmCore::semi_major, 8, 0, 255, 255, 0.05, "m"},
    {"semiMinor", &BsmCore::semi_minor, 8, 0, 255, 255, 0.05, "m"},
    {"orientation", &BsmCore::orientation, 16, 0, 65535, 65535, 360.0 / 65535.0, "deg"},
    {"transmission", &BsmCore::transmission, 3, 0, 7, 7},
    {"speed", &BsmCore::speed, 13, 0, 8191, 8191, 0.02, "m/s"},
    {"heading", &BsmCore::heading, 15, 0, 28800, 28800, 0.0125, "deg"},
    {"angle", &BsmCore::angle, 8, -126, 127, 127, 1.5, "deg"},
    {"accelSet_long", &BsmCore::accel_long, 12, -2000, 2001, 2001, 0.01, "m/s^2"},
    {"accelSet_lat", &BsmCore::accel_lat, 12, -2000, 2001, 2001, 0.01, "m/s^2"},
    {"accelSet_vert", &BsmCore::accel_vert, 8, -127, 127, -127, 0.02, "g"},
    {"accelSet_yaw", &BsmCore::accel_yaw, 16, -32767, 32767, std::nullopt, 0.01, "deg/s"},
    {"wheelBrakes", &BsmCore::wheel_brakes, 5, 0, 31},
    {"traction", &BsmCore::traction, 2, 0, 3, 0},
    {"abs", &BsmCore::abs, 2, 0, 3, 0},
    {"scs", &BsmCore::scs, 2, 0, 3, 0},
    {"brakeBoost", &BsmCore::brake_boost, 2, 0, 2, 0},
    {"auxBrakes", &BsmCore::aux_brakes, 2, 0, 3, 0},
    {"width", &BsmCore::width, 10, 0, 1023, 0, 0.01, "m"},
    {"length", &BsmCore::length, 12, 0, 4095, 0, 0.01, "m"},
}};

void ReadCore(BitReader& reader, BsmCore& core) {
  bool is_first = true;
  for (const CoreField& field : kFields) {
    core.*field.member =
        static_cast<std::int32_t>(reader.Whole(field.bits, field.low, field.high, field.name));
    if (is_first) {
      if (reader.ok() && reader.left() < 32) reader.Fail(FaultKind::kTruncated, "id");
      core.id = static_cast<std::uint32_t>(reader.Bits(32));
    }
    is_first = false;
  }
}

// An item whose content cannot be read is counted and passed over: its length is known.
void ReadContent(Bsm& bsm, const BsmItem& item) {
  if (item.id == 0 && !bsm.safety) {
    SafetyExtensions safety;
    if (ReadSafetyExtensions(item.octets, safety)) ++bsm.unread_items;
    bsm.safety = safety;
  } else if (item.id == 2 && !bsm.supplemental) {
    SupplementalExtensions supplemental;
    if (ReadSupplementalExtensions(item.octets, supplemental)) ++bsm.unread_items;
    bsm.supplemental = supplemental;
  }
}

template <std::size_t kSize>
void ReadItems(BitReader& reader, int count_bits, int id_bits, std::array<BsmItem, kSize>& items,
               std::size_t& count, std::string_view where) {
  const auto announced = static_cast<std::size_t>(reader.Bits(count_bits)) + 1;
  while (reader.ok() && count < announced) {
    BsmItem item;
    item.id = static_cast<int>(reader.Bits(id_bits));
    item.octets = reader.Octets(where);
    if (reader.ok()) items.at(count++) = item;
  }
}

}  // namespace

std::span<const CoreField> CoreFields() { return kFields; }

Fault ReadBsm(std::span<const std::uint8_t> value, Bsm& bsm) {
  BitReader reader(value);
  bsm = Bsm{};
  bsm.has_bsm_extensions = reader.Flag();
  const bool has_part_two = reader.Flag();
  const bool has_regional = reader.Flag();
  ReadCore(reader, bsm.core);
  if (!reader.ok()) return reader.fault();

  if (has_part_two) ReadItems(reader, 3, 6, bsm.part_two, bsm.part_two_count, "partII");
  if (has_regional) ReadItems(reader, 2, 8, bsm.regional, bsm.regional_count, "regional");
  if (bsm.has_bsm_extensions) reader.SkipExtensions("BasicSafetyMessage extensions");
  if (reader.ok() && reader.left() > 7) {
    reader.Fail(FaultKind::kTrailingBytes, "BasicSafetyMessage",
                static_cast<std::int64_t>(reader.left() / 8));
  }
  bsm.tail_fault = reader.fault();
  for (std::size_t i = 0; i < bsm.part_two_count; ++i) ReadContent(bsm, bsm.part_two[i]);
  return {};
}

}  // namespace v2vouch::obu
