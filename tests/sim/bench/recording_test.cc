// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "sim/bench/traffic.h"

namespace v2vouch::bench {
namespace {

using testing::HasSubstr;

constexpr const char* kHeader = "frame,t,kind,id,x,y,v,yaw,yaw_rate\n";

// A file of the test's own that goes with it.
struct ScratchFile {
  ScratchFile()
      : path(testing::TempDir() + "recording_" +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv") {}
  ~ScratchFile() { std::filesystem::remove(path); }
  std::string Fault(const std::string& text) const {
    std::ofstream(path) << text;
    std::string error;
    EXPECT_FALSE(ReadRecording(path, error).has_value()) << text;
    return error;
  }
  std::string path;
};

TEST(Recording, SurvivesWritingAndReading) {
  const ScratchFile file;
  const Recording out = GenerateTraffic({.vehicles = 12, .seed = 1, .frames = 15});
  std::string error;
  ASSERT_TRUE(WriteRecording(out, file.path, error)) << error;
  const auto in = ReadRecording(file.path, error);
  ASSERT_TRUE(in.has_value()) << error;
  ASSERT_EQ(in->size(), out.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    EXPECT_EQ((*in)[k].number, out[k].number);
    EXPECT_NEAR((*in)[k].time_s, out[k].time_s, 1e-3);
    ASSERT_EQ((*in)[k].truth.size(), out[k].truth.size());
    ASSERT_EQ((*in)[k].detections.size(), out[k].detections.size());
    for (std::size_t i = 0; i < out[k].detections.size(); ++i) {
      EXPECT_NEAR((*in)[k].detections[i].x_m, out[k].detections[i].x_m, 1e-4);
      EXPECT_NEAR((*in)[k].detections[i].yaw_rad, out[k].detections[i].yaw_rad, 1e-5);
    }
  }
}

TEST(Recording, FaultsNameFileAndLine) {
  const ScratchFile file;
  const std::string good = "0,0.0,T,1,1,2,3,4,5\n";
  EXPECT_THAT(file.Fault(kHeader + good + "0,0.0,X,1,1,2,3,4,5\n"),
              HasSubstr(file.path + ":3: kind is neither T nor D"));
  EXPECT_THAT(file.Fault(kHeader + good + "0,0.0,D,1,one,2,3,4,5\n"),
              HasSubstr(":3: x = \"one\" is not a number"));
  EXPECT_THAT(file.Fault(kHeader + good + "0,0.0,D,1,nan,2,3,4,5\n"), HasSubstr(":3: x = "));
  EXPECT_THAT(file.Fault(kHeader + good + "0,0.0,D,1,1,2,3,4\n"), HasSubstr(":3: has 8 fields"));
  EXPECT_THAT(file.Fault(kHeader + good + "1,0.0,D,1,1,2,3,4,5\n"), HasSubstr("t does not rise"));
  EXPECT_THAT(file.Fault(kHeader + good + "-1,1.0,D,1,1,2,3,4,5\n"), HasSubstr("frame goes back"));
  EXPECT_THAT(file.Fault(kHeader + good + "0.5,1.0,D,1,1,2,3,4,5\n"),
              HasSubstr("frame is not a whole number"));
  EXPECT_THAT(file.Fault(kHeader + good + "0,0.1,D,1,1,2,3,4,5\n"), HasSubstr("t differs"));
  EXPECT_THAT(file.Fault(kHeader), HasSubstr("has no frame"));
  EXPECT_THAT(file.Fault("frame,t,kind,id,x,y,v,yaw\n"), HasSubstr("lacks the column(s) yaw_rate"));
  EXPECT_THAT(file.Fault(""), HasSubstr("is empty"));
  std::string error;
  EXPECT_FALSE(ReadRecording("/nonexistent.csv", error).has_value());
  EXPECT_THAT(error, HasSubstr("/nonexistent.csv: cannot be opened"));
}

}  // namespace
}  // namespace v2vouch::bench
