// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/j2735/part_two.h"

namespace v2vouch::obu {
namespace {

// Which optional parts of a sequence are there: first bit = index 0.
class Presence {
 public:
  Presence(BitReader& reader, int count) : count_(count), bits_(reader.Bits(count)) {}
  [[nodiscard]] bool Has(int index) const { return (bits_ >> (count_ - 1 - index)) & 1U; }

 private:
  int count_;
  std::uint64_t bits_;
};

// A bit string of `root` bits, or longer behind an extension bit. Result: bit i = bit i of the
// string.
std::uint16_t BitString(BitReader& reader, int root, std::string_view where) {
  auto count = static_cast<std::size_t>(root);
  if (reader.Flag()) count = reader.Length(where);
  std::uint16_t set = 0;
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    if (reader.Flag() && i < 16) set = static_cast<std::uint16_t>(set | (1U << i));
  }
  return set;
}

// An enumerated type that can grow: `bits` for the values it had first, else a small number.
int Enumerated(BitReader& reader, int bits, std::string_view where) {
  if (!reader.Flag()) return static_cast<int>(reader.Bits(bits));
  if (reader.Flag()) reader.Fail(FaultKind::kOutOfRange, where);
  return (1 << bits) + static_cast<int>(reader.Bits(6));
}

void SkipFullPosition(BitReader& reader) {
  const bool is_extended = reader.Flag();
  const Presence has(reader, 8);
  if (has.Has(0)) {  // utcTime: year, month, day, hour, minute, second, offset.
    const Presence part(reader, 7);
    static constexpr int kBits[] = {12, 4, 5, 5, 6, 16, 11};
    for (int i = 0; i < 7; ++i) {
      if (part.Has(i)) reader.Skip(static_cast<std::size_t>(kBits[i]), "utcTime");
    }
  }
  reader.Skip(32 + 31, "initialPosition");
  // elevation, heading, speed, accuracy, timeConfidence, posConfidence, speedConfidence.
  static constexpr int kBits[] = {16, 15, 16, 32, 6, 8, 8};
  for (int i = 0; i < 7; ++i) {
    if (has.Has(i + 1)) reader.Skip(static_cast<std::size_t>(kBits[i]), "initialPosition");
  }
  if (is_extended) reader.SkipExtensions("initialPosition");
}

int ReadPathHistory(BitReader& reader) {
  const bool is_extended = reader.Flag();
  const Presence has(reader, 2);
  if (has.Has(0)) SkipFullPosition(reader);
  if (has.Has(1)) reader.Skip(8, "gnssStatus");
  const auto count = static_cast<int>(reader.Whole(5, 1, 23, "pathHistory points"));
  for (int i = 0; i < count && reader.ok(); ++i) {
    const bool point_is_extended = reader.Flag();
    const Presence part(reader, 3);
    reader.Skip(18 + 18 + 12 + 16, "pathHistory point");
    if (part.Has(0)) reader.Skip(13, "pathHistory speed");
    if (part.Has(1)) reader.Skip(32, "pathHistory accuracy");
    if (part.Has(2)) reader.Skip(8, "pathHistory heading");
    if (point_is_extended) reader.SkipExtensions("pathHistory point");
  }
  if (is_extended) reader.SkipExtensions("pathHistory");
  return count;
}

}  // namespace

Fault ReadSafetyExtensions(BitView content, SafetyExtensions& safety) {
  BitReader reader(content);
  const bool is_extended = reader.Flag();
  const Presence has(reader, 4);
  if (has.Has(0)) {
    const std::uint16_t events = BitString(reader, 13, "events");
    if (reader.ok()) safety.events = events;
  }
  if (has.Has(1)) {
    const int points = ReadPathHistory(reader);
    if (reader.ok()) safety.path_points = points;
  }
  if (has.Has(2)) {
    const bool prediction_is_extended = reader.Flag();
    const auto radius = static_cast<std::int32_t>(reader.Whole(16, -32767, 32767, "radiusOfCurve"));
    const auto confidence = static_cast<int>(reader.Whole(8, 0, 200, "confidence"));
    if (prediction_is_extended) reader.SkipExtensions("pathPrediction");
    if (reader.ok()) {
      safety.radius_of_curve = radius;
      safety.prediction_confidence = confidence;
    }
  }
  if (has.Has(3)) {
    const std::uint16_t lights = BitString(reader, 9, "lights");
    if (reader.ok()) safety.lights = lights;
  }
  if (is_extended) reader.SkipExtensions("VehicleSafetyExtensions");
  return reader.fault();
}

Fault ReadSupplementalExtensions(BitView content, SupplementalExtensions& supplemental) {
  BitReader reader(content);
  reader.Flag();  // Additions come last; nothing behind vehicleData is read.
  const Presence has(reader, 10);
  if (has.Has(0)) {
    const auto vehicle_class = static_cast<int>(reader.Bits(8));
    if (reader.ok()) supplemental.vehicle_class = vehicle_class;
  }
  if (has.Has(1)) {
    const bool is_extended = reader.Flag();
    const Presence part(reader, 9);
    if (part.Has(0)) reader.Skip(8, "keyType");
    if (part.Has(1)) {
      const int role = Enumerated(reader, 5, "role");
      if (reader.ok()) supplemental.role = role;
    }
    if (part.Has(2)) reader.Skip(7, "iso3883");
    if (part.Has(3)) Enumerated(reader, 4, "hpmsType");
    if (part.Has(4) || part.Has(5) || part.Has(6) || part.Has(8)) {
      reader.Fail(FaultKind::kUnsupported, "classDetails");
    }
    if (part.Has(7)) reader.Skip(4, "fuelType");
    if (is_extended) reader.SkipExtensions("classDetails");
  }
  if (has.Has(2)) {
    reader.Flag();
    const Presence part(reader, 4);
    if (part.Has(0)) {
      const auto height = static_cast<int>(reader.Bits(7));
      if (reader.ok()) supplemental.height = height;
    }
  }
  return reader.fault();
}

}  // namespace v2vouch::obu
