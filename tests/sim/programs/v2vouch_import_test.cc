// SPDX-License-Identifier: Apache-2.0
// v2vouch-import as its users meet it: a child process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "daemon/rim/io/event_log.h"
#include "tests/sim/import/files.h"
#include "tests/support/child_process.h"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;

Finished Import(const std::string& arguments) { return Called(V2VOUCH_IMPORT, arguments); }

// One second of a drive with one car 30 m ahead.
void WriteDrive(const ScratchFolder& folder) {
  std::string radar = "t_boot_s,long_dist_m,lat_left_m,rel_speed_mps,can_address,new_track\n";
  std::string speed = "t_boot_s,speed_mps\n";
  std::string gyro = "t_boot_s,gz_radps\n";
  std::string fixes = "t_boot_s,lat_deg,lon_deg,speed_mps,utc_ms,alt_m,bearing_deg\n";
  for (int k = 0; k < 100; ++k) {
    const std::string t = std::to_string(10.0 + 0.01 * k);
    speed += t + ",10\n";
    gyro += t + ",0.01\n";
    if (k % 5 == 0) radar += t + ",32.7,0.5,-1,535,0\n";
    if (k % 10 == 0) {
      fixes += t + ",37,-122,10," + std::to_string(1533226488000 + 10 * k) + ",5,2\n";
    }
  }
  folder.Write("radar_tracks.csv", radar);
  folder.Write("ego_speed.csv", speed);
  folder.Write("imu_fwd_right_down.csv", gyro);
  folder.Write("gnss_ublox.csv", fixes);
}

TEST(V2vouchImport, TellsUsageErrorsFromFailures) {
  EXPECT_EQ(Import("--version").code, 0);
  EXPECT_THAT(Import("--help").output, HasSubstr("Examples:"));
  EXPECT_EQ(Import("").code, 2);
  EXPECT_EQ(Import("comma2k19").code, 2);
  EXPECT_EQ(Import("sumo-fcd f.csv --out-scenario o --v2v-share 1.5").code, 2);
  const Finished missing = Import("comma2k19 /nonexistent --out /tmp/x.lcm");
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.output, HasSubstr("/nonexistent: is no folder"));
}

TEST(V2vouchImport, ADriveBecomesALogOfAllItsChannels) {
  const ScratchFolder folder("import");
  WriteDrive(folder);
  const std::string log = folder.path() + "/drive.lcm";
  const Finished finished = Import("comma2k19 " + folder.path() + " --out " + log + " --json");
  ASSERT_EQ(finished.code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("\"events\":130"));
  std::string error;
  const auto reader = LogReader::Open(log, error);
  ASSERT_NE(reader, nullptr) << error;
  std::map<std::string, int> channels;
  LogEvent event;
  while (reader->Next(event)) ++channels[event.channel];
  const std::map<std::string, int> expected{
      {"EGO_GNSS", 10}, {"EGO_MOTION", 100}, {"RADAR_FRONT", 20}};
  EXPECT_EQ(channels, expected);
}

TEST(V2vouchImport, ALogThatCannotBeWrittenIsAFailure) {
  const ScratchFolder folder("import");
  WriteDrive(folder);
  EXPECT_EQ(Import("comma2k19 " + folder.path() + " --out /nonexistent/drive.lcm").code, 1);
}

TEST(V2vouchImport, AFaultyTableNamesItsLine) {
  const ScratchFolder folder("import");
  const std::string table =
      folder.Write("fcd.csv",
                   "time_s,id,type,lon_deg,lat_deg,x_m,y_m,heading_deg_cw_from_north,speed_mps\n"
                   "0.0,a,car,7,51,0,0,90,10\n0.1,a,car,7,51,one,0,90,10\n");
  const Finished finished = Import("sumo-fcd " + table + " --out-scenario " + folder.path() + "/s");
  EXPECT_EQ(finished.code, 1);
  EXPECT_THAT(finished.output, HasSubstr("fcd.csv:3: x_m = \"one\" is not a number"));
}

// Three standing cars that the ego nears at 10 m/s.
std::string NearingLabels() {
  std::string text;
  for (int k = 0; k < 20; ++k) {
    for (int track = 0; track < 3; ++track) {
      text += std::to_string(k) + " " + std::to_string(track) +
              " Car 0 0 0 600 180 640 210 1.5 1.8 4.2 " + std::to_string(4 * track - 6) + " 1.6 " +
              std::to_string(40 + 5 * track - k) + " -1.57\n";
    }
  }
  return text;
}

TEST(V2vouchImport, KittiLabelsBecomeALog) {
  const ScratchFolder folder("import_app");
  const std::string calibration =
      " --calib " + folder.Write("calib.txt", "P2: 721 0 609 45 0 721 172 0 0 0 1 0\n");
  const std::string labels = " --labels " + folder.Write("labels.txt", NearingLabels());
  const std::string out = " --out " + folder.path() + "/kitti.lcm";
  const Finished done = Import("kitti --json" + labels + calibration + out);
  ASSERT_EQ(done.code, 0) << done.output;
  EXPECT_THAT(done.output, HasSubstr("\"frames\":20"));
  EXPECT_THAT(done.output, HasSubstr("\"ego_from\":\"labels\""));
  EXPECT_THAT(done.output, HasSubstr("\"CAMERA_FRONT\":20"));

  EXPECT_EQ(Import("kitti" + labels + out).code, 2);  // No calibration.
  EXPECT_THAT(Import("kitti" + calibration + out).output, HasSubstr("--labels, --images or both"));
  const Finished empty = Import("kitti" + calibration + out + " --images " + folder.path());
  EXPECT_EQ(empty.code, 1);
  EXPECT_THAT(empty.output, HasSubstr("holds no numbered picture"));
}

// Real pictures into a log, sizes and all.
TEST(V2vouchImport, KittiPicturesBecomeALog) {
  const auto images = ReferenceData("images/kitti_seq");
  if (!std::filesystem::exists(images)) GTEST_SKIP() << "SKIPPED: no pictures under V2VOUCH_DATA";
  const ScratchFolder folder("import_app");
  const Finished done =
      Import("kitti --json --ego-speed 5 --images " + images.string() + " --calib " +
             ReferenceData("images/kitti_tracking/calib_0001.txt").string() + " --out " +
             folder.path() + "/pictures.lcm");
  ASSERT_EQ(done.code, 0) << done.output;
  EXPECT_THAT(done.output, HasSubstr("\"CAMERA_FRONT_IMAGE\":20"));
}

}  // namespace
}  // namespace v2vouch::sim
