// SPDX-License-Identifier: Apache-2.0
// Fixes of real GNSS receivers, told as BSMs: what the message checks hold against them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/daemon/v2v/intake/talking_car.h"
#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

// All numbers of a file with one line of headings; empty where there is no such file.
std::vector<std::vector<double>> Read(const std::string& name) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(DataFolder() / name);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double>& row = rows.emplace_back();
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
  }
  return rows;
}

struct Fix {
  double time_s = 0.0;
  Wgs84 place;
  double speed_mps = 0.0;
  double course_rad = 0.0;
  double latency_s = 0.15;
};

struct Tally {
  int claims = 0;
  int withdrawn = 0;
  int accused = 0;
};

Tally Judge(const std::vector<Fix>& fixes, const char* name, double accuracy_m = 2.0) {
  BsmIntake intake{IntakeConfig{.max_senders = 16, .repeat_memory_s = 1.0}};
  Tally tally;
  std::map<std::string, int> checks;
  int count = 0;
  for (const Fix& fix : fixes) {
    Bsm bsm;
    bsm.stamp = FromMicros(kNoon_us) + FromSeconds(fix.time_s + fix.latency_s);
    bsm.sender = 7;
    bsm.msg_count = count++ % 128;
    bsm.sec_mark_ms = static_cast<int>(std::llround(fix.time_s * 1000.0) % 60000);
    bsm.latitude_rad = fix.place.latitude_rad;
    bsm.longitude_rad = fix.place.longitude_rad;
    bsm.elevation_m = fix.place.height_m;
    bsm.semi_major_m = accuracy_m;
    bsm.transmission = Transmission::kForward;
    bsm.speed_mps = fix.speed_mps;
    bsm.course_rad = fix.course_rad;
    EgoPlace ego;  // A hundred metres east of it.
    ego.is_known = true;
    ego.p_E = LocalPlane(fix.place).ToEcefPoint(LocalPoint{{100.0, 0.0, 0.0}}).p_E;
    const auto claim = intake.Accept(bsm, ego);
    if (!claim) continue;
    ++tally.claims;
    if (!claim->finding) continue;
    ++(claim->finding->severity == Verdict::kAccuse ? tally.accused : tally.withdrawn);
    ++checks[std::string(NameOf(claim->finding->check))];
  }
  std::cout << name << ": " << tally.claims << " claims, " << tally.withdrawn << " withdrawn, "
            << tally.accused << " accused;";
  for (const auto& [check, number] : checks) std::cout << " " << check << " " << number;
  std::cout << "\n";
  return tally;
}

// The receiver of a car on a motorway, 10 Hz, with its own speed and course; with the speed of the
// car's wheels instead, which read 0.8 % low; and every third fix only, as after loss.
TEST(RealReceivers, ACarsReceiverIsNeverFound) {
  const auto rows = Read("radar/comma2k19_segment/gnss_ublox.csv");
  const auto wheels = Read("radar/comma2k19_segment/ego_speed.csv");
  if (rows.empty() || wheels.empty()) GTEST_SKIP() << "SKIPPED: no data in " << DataFolder();
  std::vector<Fix> own;
  std::vector<Fix> by_wheels;
  std::vector<Fix> few;
  std::size_t wheel = 0;
  for (const auto& row : rows) {
    Fix fix;
    fix.time_s = 1e-3 * (row[4] - rows[0][4]);
    // Nothing is received before it was measured.
    fix.latency_s = 0.1 + std::max(0.0, row[0] - rows[0][0] - fix.time_s);
    fix.place = {FromDegrees(row[1]), FromDegrees(row[2]), row[5]};
    fix.speed_mps = row[3];
    fix.course_rad = WrapAngle(FromDegrees(90.0 - row[6]));
    own.push_back(fix);
    if (own.size() % 3 == 0) few.push_back(fix);
    while (wheel + 1 < wheels.size() && wheels[wheel][0] < row[0] - 0.1) ++wheel;
    fix.speed_mps = wheels[wheel][1];
    by_wheels.push_back(fix);
  }
  ASSERT_GT(own.size(), 300U);
  EXPECT_EQ(Judge(own, "u-blox").withdrawn, 0);
  EXPECT_EQ(Judge(by_wheels, "u-blox, speed of the wheels").withdrawn, 0);
  EXPECT_EQ(Judge(few, "u-blox, every third").withdrawn, 0);
}

// The worst there is: unfiltered fixes among high buildings, tens of metres off and jumping. They
// are what a random offset looks like, and a unit that sent them as good to 2 m would be accused
// now and then. One that tells how poor they are is not judged by them.
TEST(RealReceivers, RawFixesInAStreetCanyonAreWithdrawnUnlessTheAccuracyIsTold) {
  const auto rows = Read("gnss/smartloc_potsdamer_platz_ls_fix_vs_truth.csv");
  if (rows.empty()) GTEST_SKIP() << "SKIPPED: no data in " << DataFolder();
  std::vector<Fix> fixes;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const auto& last = rows[i - 1];
    const double dt = row[0] - last[0];
    if (dt <= 0.0) continue;
    const Wgs84 truth = ToWgs84({{row[5], row[6], row[7]}});
    const Eigen::Vector3d moved =
        LocalPlane(truth).R_LE() *
        Eigen::Vector3d(row[5] - last[5], row[6] - last[6], row[7] - last[7]);
    Fix fix;
    fix.time_s = row[0];
    fix.place = ToWgs84({{row[1], row[2], row[3]}});
    fix.speed_mps = moved.head<2>().norm() / dt;
    fix.course_rad = std::atan2(moved.y(), moved.x());
    fixes.push_back(fix);
  }
  const Tally told = Judge(fixes, "street canyon, raw fixes, accuracy told", 12.65);
  EXPECT_EQ(told.accused, 0);
  EXPECT_EQ(told.withdrawn, 0);
  const Tally tally = Judge(fixes, "street canyon, raw fixes said to be good");
  EXPECT_GT(tally.withdrawn, tally.claims / 4);
  EXPECT_LT(tally.accused, tally.claims / 20);
}

}  // namespace
}  // namespace v2vouch
