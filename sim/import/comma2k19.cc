// SPDX-License-Identifier: Apache-2.0
#include "sim/import/comma2k19.h"

#include <cmath>

#include "sim/import/csv.h"

namespace v2vouch::sim {
namespace {

// Calls `on_row(csv)` for every row; column 0 is the time, which may not go back.
template <class OnRow>
bool ReadRows(const std::string& path, const std::vector<std::string>& columns, std::string& error,
              OnRow on_row) {
  const auto csv = CsvReader::Open(path, columns, error);
  if (csv == nullptr) return false;
  double last_s = -1.0;
  bool any = false;
  while (csv->Next()) {
    const double t_s = csv->Number(0);
    // 1e9 s of uptime is 31 years; beyond it microseconds would lose digits.
    if (t_s < 0.0 || t_s > 1e9) csv->Fail("time is outside 0..1e9 s");
    if (t_s < last_s) csv->Fail("time goes back");
    last_s = t_s;
    on_row(*csv, t_s);
    any = true;
  }
  error = csv->error();
  if (error.empty() && !any) error = path + ": holds no row";
  return error.empty();
}

void CheckWithin(CsvReader& csv, double value, double low, double high, const char* what) {
  if (value < low || value > high) csv.Fail(std::string(what) + " is out of range");
}

}  // namespace

bool ReadComma2k19(const std::string& folder, Comma2k19Segment& segment, std::string& error) {
  const auto read_radar = [&](CsvReader& csv, double t_s) {
    const double slot = csv.Number(4);
    CheckWithin(csv, slot, 0.0, 65535.0, "can_address");
    CheckWithin(csv, csv.Number(1), -1e4, 1e4, "long_dist_m");
    CheckWithin(csv, csv.Number(2), -1e4, 1e4, "lat_left_m");
    if (!csv.error().empty()) return;
    segment.radar.push_back(
        {t_s, csv.Number(1), csv.Number(2), csv.Number(3), static_cast<int>(slot)});
  };
  const auto read_fix = [&](CsvReader& csv, double t_s) {
    const double utc_ms = csv.Number(4);
    CheckWithin(csv, utc_ms, 0.0, 4.1e12, "utc_ms");  // Up to 2099.
    CheckWithin(csv, csv.Number(1), -90.0, 90.0, "lat_deg");
    CheckWithin(csv, csv.Number(2), -180.0, 180.0, "lon_deg");
    if (!csv.error().empty()) return;
    segment.fixes.push_back({t_s, csv.Number(1), csv.Number(2), csv.Number(3), std::llround(utc_ms),
                             csv.Number(5), csv.Number(6)});
  };
  return ReadRows(folder + "/radar_tracks.csv",
                  {"t_boot_s", "long_dist_m", "lat_left_m", "rel_speed_mps", "can_address"}, error,
                  read_radar) &&
         ReadRows(folder + "/ego_speed.csv", {"t_boot_s", "speed_mps"}, error,
                  [&](CsvReader& csv, double t_s) {
                    segment.speed.push_back({t_s, csv.Number(1)});
                  }) &&
         ReadRows(folder + "/imu_fwd_right_down.csv", {"t_boot_s", "gz_radps"}, error,
                  [&](CsvReader& csv, double t_s) {
                    segment.gyro.push_back({t_s, csv.Number(1)});
                  }) &&
         ReadRows(folder + "/gnss_ublox.csv",
                  {"t_boot_s", "lat_deg", "lon_deg", "speed_mps", "utc_ms", "alt_m", "bearing_deg"},
                  error, read_fix);
}

}  // namespace v2vouch::sim
