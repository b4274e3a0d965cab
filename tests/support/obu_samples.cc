// SPDX-License-Identifier: Apache-2.0
#include "tests/support/obu_samples.h"

#include <zlib.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

// Of the vectors' names of enumerated values.
int EnumValue(const nlohmann::json& value, const std::map<std::string, int>& names) {
  if (value.is_number()) return value.get<int>();
  return names.at(value.get<std::string>());
}

obu::BsmCore CoreOfVector(const nlohmann::json& core) {
  static const std::map<std::string, int> kTransmission = {
      {"neutral", 0},   {"park", 1},      {"forwardGears", 2}, {"reverseGears", 3},
      {"reserved1", 4}, {"reserved2", 5}, {"reserved3", 6},    {"unavailable", 7}};
  static const std::map<std::string, int> kState = {
      {"unavailable", 0}, {"off", 1}, {"on", 2}, {"engaged", 3}, {"reserved", 3}};
  obu::BsmCore out;
  out.msg_count = core.at("msgCnt");
  out.id = static_cast<std::uint32_t>(std::stoul(core.at("id").get<std::string>(), nullptr, 16));
  out.sec_mark = core.at("secMark");
  out.lat = core.at("lat");
  out.lon = core.at("long");
  out.elev = core.at("elev");
  out.semi_major = core.at("semiMajor");
  out.semi_minor = core.at("semiMinor");
  out.orientation = core.at("orientation");
  out.transmission = EnumValue(core.at("transmission"), kTransmission);
  out.speed = core.at("speed");
  out.heading = core.at("heading");
  out.angle = core.at("angle");
  out.accel_long = core.at("accelLong");
  out.accel_lat = core.at("accelLat");
  out.accel_vert = core.at("accelVert");
  out.accel_yaw = core.at("accelYaw");
  out.wheel_brakes =
      static_cast<int>(std::stoul(core.at("wheelBrakes").get<std::string>(), nullptr, 2));
  out.traction = EnumValue(core.at("traction"), kState);
  out.abs = EnumValue(core.at("abs"), kState);
  out.scs = EnumValue(core.at("scs"), kState);
  out.brake_boost = EnumValue(core.at("brakeBoost"), kState);
  out.aux_brakes = EnumValue(core.at("auxBrakes"), kState);
  out.width = core.at("width");
  out.length = core.at("length");
  return out;
}

nlohmann::json Vectors() {
  std::ifstream file(DataFolder() / "j2735_bsm_vectors.json");
  return file ? nlohmann::json::parse(file) : nlohmann::json();
}

using Row = std::map<std::string, std::string>;

std::vector<Row> ReadCsv(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.ends_with('\r')) line.pop_back();
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    Row row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = i < cells.size() ? cells[i] : "";
    rows.push_back(row);
  }
  return rows;
}

obu::BsmCore CoreOfRow(const Row& row) {
  const auto number = [&row](const char* name) { return std::stoi(row.at(name)); };
  obu::BsmCore core;
  core.msg_count = number("msgCnt");
  core.id = static_cast<std::uint32_t>(std::stoul(row.at("id"), nullptr, 16));
  core.sec_mark = number("secMark");
  core.lat = number("lat");
  core.lon = number("long");
  core.elev = number("elev");
  core.semi_major = number("semiMajor");
  core.semi_minor = number("semiMinor");
  core.orientation = number("orientation");
  core.transmission = number("transmission");
  core.speed = number("speed");
  core.heading = number("heading");
  core.angle = number("angle");
  core.accel_long = number("accelLong");
  core.accel_lat = number("accelLat");
  core.accel_vert = number("accelVert");
  core.accel_yaw = number("accelYaw");
  core.wheel_brakes = number("wheelBrakes");
  core.traction = number("traction");
  core.abs = number("abs");
  core.scs = number("scs");
  core.brake_boost = number("brakeBoost");
  core.aux_brakes = number("auxBrakes");
  core.width = number("width");
  core.length = number("length");
  return core;
}

// gzread() hands plain files through.
Octets Unpacked(const std::string& path) {
  Octets bytes;
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) return bytes;
  Octets piece(65536);
  for (int n = 0; (n = gzread(file, piece.data(), static_cast<unsigned>(piece.size()))) > 0;) {
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + n);
  }
  gzclose(file);
  return bytes;
}

}  // namespace

Octets FromHex(const std::string& hex) {
  Octets bytes;
  std::string digits;
  for (const char letter : hex) {
    if (std::isxdigit(static_cast<unsigned char>(letter)) == 0) continue;
    digits += letter;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

std::vector<BsmVector> BsmVectors() {
  std::vector<BsmVector> vectors;
  const nlohmann::json json = Vectors();
  for (const auto& vector : json.at("vectors")) {
    vectors.push_back({FromHex(vector.at("hex")), CoreOfVector(vector.at("core")),
                       vector.at("frame").at("frameExtBit") == 1});
  }
  return vectors;
}

std::vector<BsmReject> BsmRejects() {
  std::vector<BsmReject> rejects;
  const nlohmann::json json = Vectors();
  for (const auto& reject : json.at("reject")) {
    rejects.push_back({FromHex(reject.at("hex")), reject.at("why")});
  }
  return rejects;
}

std::vector<UnitRecord> UnitRecords() {
  // Little endian, no padding: direction u8, lat, lon, elevation i32, speed, heading u16, seconds
  // u32, milliseconds u16, status i8, length u16; then the bytes.
  constexpr std::size_t kHeader = 26;
  std::vector<UnitRecord> records;
  for (const char* name : {"bsmTx_commsignia.gz", "bsmLogDuringEvent_commsignia.gz",
                           "rxMsg_BSM_and_TIM.gz", "bsmTx.bin"}) {
    const std::string path = ObuPath("wydot/") + name;
    const Octets bytes = Unpacked(path);
    std::map<std::size_t, Row> rows;
    for (const Row& row : ReadCsv(path + ".expected.csv")) rows[std::stoul(row.at("record"))] = row;
    std::size_t index = 0;
    for (std::size_t at = 0; at + kHeader <= bytes.size(); ++index) {
      const std::size_t size = bytes[at + 24] + std::size_t{256} * bytes[at + 25];
      if (at + kHeader + size > bytes.size()) throw std::runtime_error(path + ": cut off");
      UnitRecord record;
      record.file = name;
      const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at + kHeader);
      record.bytes.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
      at += kHeader + size;
      while (at < bytes.size() && bytes[at] == '\n') ++at;  // Between records of two files.
      if (const auto row = rows.find(index); row != rows.end()) {
        record.is_bsm = true;
        record.core = CoreOfRow(row->second);
        record.log_utime = std::stoll(row->second.at("log_time_ms_utc")) * 1000;
        const std::string& generation = row->second.at("generation_utime_utc");
        if (!generation.empty()) record.generation_utime = std::stoll(generation);
        record.digest = row->second.at("hashedId8");
        record.signer = row->second.at("signer");
      }
      records.push_back(std::move(record));
    }
  }
  return records;
}

std::string ObuPath(const std::string& name) { return (DataFolder() / "obu" / name).string(); }

Octets ObuFile(const std::string& name) {
  std::ifstream file(ObuPath(name), std::ios::binary);
  return Octets(std::istreambuf_iterator<char>(file), {});
}

bool HasObuData() { return std::ifstream(ObuPath("README.md")).good(); }

}  // namespace v2vouch
