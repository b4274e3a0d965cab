// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "daemon/obu/octets/bit_reader.h"

namespace v2vouch::obu {

/// BSMcoreData of SAE J2735 Part I as raw integers. Units, ranges and the codes for "unavailable"
/// are in CoreFields(), and beside the fields of the same names in lcmtypes/bsm_t.lcm. A value made
/// by default says "unavailable" everywhere: a zero would be a claim.
struct BsmCore {
  std::int32_t msg_count = 0;
  std::uint32_t id = 0;  ///< TemporaryID, first octet in the highest byte.
  std::int32_t sec_mark = 65535;
  std::int32_t lat = 900000001;
  std::int32_t lon = 1800000001;
  std::int32_t elev = -4096;
  std::int32_t semi_major = 255;
  std::int32_t semi_minor = 255;
  std::int32_t orientation = 65535;
  std::int32_t transmission = 7;
  std::int32_t speed = 8191;
  std::int32_t heading = 28800;
  std::int32_t angle = 127;
  std::int32_t accel_long = 2001;
  std::int32_t accel_lat = 2001;
  std::int32_t accel_vert = -127;
  std::int32_t accel_yaw = 0;
  std::int32_t wheel_brakes = 16;  ///< Most significant of five bits first.
  std::int32_t traction = 0;
  std::int32_t abs = 0;
  std::int32_t scs = 0;
  std::int32_t brake_boost = 0;
  std::int32_t aux_brakes = 0;
  std::int32_t width = 0;
  std::int32_t length = 0;

  friend bool operator==(const BsmCore&, const BsmCore&) = default;
};

/// One field of the core but the id.
struct CoreField {
  std::string_view name;  ///< As in bsm_t.lcm.
  std::int32_t BsmCore::*member;
  int bits;
  std::int32_t low;
  std::int32_t high;  ///< Highest value the standard defines.
  std::optional<std::int32_t> unavailable{};
  double unit = 1.0;  ///< Raw times this is in `unit_name`.
  std::string_view unit_name{};
};

/// In the order of the wire; the id comes after the first.
std::span<const CoreField> CoreFields();

/// One item of Part II, or one regional extension, as it came.
struct BsmItem {
  int id = 0;      ///< Part II: 0 safety, 1 special, 2 supplemental. Regional: the region.
  BitView octets;  ///< Content; points into the datagram.
};

/// What is read of Part II item 0, VehicleSafetyExtensions.
struct SafetyExtensions {
  std::optional<std::uint16_t> events;          ///< Bit i = event i (7 hard braking, 13 jackknife).
  std::optional<int> path_points;               ///< Points of the path history.
  std::optional<std::int32_t> radius_of_curve;  ///< 0.1 m, right positive; 32767 straight.
  int prediction_confidence = 0;                ///< 0.5 %; 0 means no statement.
  std::optional<std::uint16_t> lights;          ///< Bit i = light i (low beam first).
};

/// What is read of Part II item 2, SupplementalVehicleExtensions.
struct SupplementalExtensions {
  std::optional<int> vehicle_class;  ///< BasicVehicleClass.
  std::optional<int> role;           ///< BasicVehicleRole.
  std::optional<int> height;         ///< 5 cm.
};

struct Bsm {
  BsmCore core;
  std::array<BsmItem, 8> part_two{};
  std::size_t part_two_count = 0;
  std::array<BsmItem, 4> regional{};
  std::size_t regional_count = 0;
  std::optional<SafetyExtensions> safety;
  std::optional<SupplementalExtensions> supplemental;
  bool has_frame_extensions = false;
  bool has_bsm_extensions = false;
  int unread_items = 0;  ///< Items of a kind read here whose content could not be read.
  Fault tail_fault;      ///< What ended the reading behind the core; the core is good all the same.
};

inline constexpr int kBsmMessageId = 20;

/// Reads the value of a BSM message, i.e. the content of a MessageFrame's open type.
/// @return what is wrong with the core; an item behind the core never costs the core.
Fault ReadBsm(std::span<const std::uint8_t> value, Bsm& bsm);

}  // namespace v2vouch::obu
