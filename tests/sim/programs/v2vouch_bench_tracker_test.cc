// SPDX-License-Identifier: Apache-2.0
// v2vouch-bench-tracker as its users meet it: a child process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/data_folder.h"

namespace v2vouch::bench {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Finished Bench(const std::string& arguments) { return Called(V2VOUCH_BENCH_TRACKER, arguments); }

// The value behind a key of the flat JSON object.
double Value(const std::string& json, const std::string& key) {
  const std::size_t at = json.find("\"" + key + "\":");
  if (at == std::string::npos) ADD_FAILURE() << key << " is missing in " << json;
  return at == std::string::npos ? -1.0 : std::atof(json.c_str() + at + key.size() + 3);
}

TEST(V2vouchBenchTracker, TellsUsageErrorsFromFailures) {
  EXPECT_EQ(Bench("--version").code, 0);
  EXPECT_THAT(Bench("--help").output, HasSubstr("Examples:"));
  EXPECT_EQ(Bench("").code, 2);
  EXPECT_EQ(Bench("a.csv --generate 10").code, 2);
  EXPECT_EQ(Bench("--generate 10 --seeds five").code, 2);
  EXPECT_EQ(Bench("--generate 10 --seeds 1-3 --out x.csv").code, 2);
  EXPECT_EQ(Bench("--generate 10 --sigma-yaw 0").code, 2);
  const Finished missing = Bench("/nonexistent.csv");
  EXPECT_EQ(missing.code, 1);
  EXPECT_THAT(missing.output, HasSubstr("/nonexistent.csv: cannot be opened"));
}

TEST(V2vouchBenchTracker, NamesFileAndLineOfAFault) {
  const std::string path = testing::TempDir() + "bench_tracker_fault.csv";
  std::ofstream(path)
      << "frame,t,kind,id,x,y,v,yaw,yaw_rate\n0,0,T,0,1,2,3,4,5\n0,0,T,0,1,2,3,4,?\n";
  const Finished finished = Bench("'" + path + "' --json");
  EXPECT_EQ(finished.code, 1);
  EXPECT_THAT(finished.output, HasSubstr(path + ":3: yaw_rate = \"?\" is not a number"));
  std::filesystem::remove(path);
}

TEST(V2vouchBenchTracker, AFileGivesWhatItsTrafficGives) {
  const std::string path = testing::TempDir() + "bench_tracker_traffic.csv";
  const std::string traffic = "--generate 30 --seeds 12 --frames 80";
  ASSERT_EQ(Bench(traffic + " --out '" + path + "'").code, 0);
  const Finished direct = Bench(traffic + " --json");
  const Finished read = Bench("'" + path + "' --json");
  ASSERT_EQ(direct.code, 0);
  ASSERT_EQ(read.code, 0) << read.output;
  EXPECT_THAT(read.output, StartsWith("{\"gospa_mean\":"));
  for (const char* key : {"gospa_mean", "rmse_m"}) {
    EXPECT_NEAR(Value(read.output, key), Value(direct.output, key), 1e-3);  // Four decimals.
    EXPECT_GT(Value(read.output, key), 0.0);
  }
  EXPECT_EQ(Value(read.output, "false_tracks"), 0.0);
  EXPECT_EQ(Value(read.output, "switches"), 0.0);
  EXPECT_GT(Value(read.output, "ms_p95"), 0.0);
  EXPECT_LE(Value(read.output, "ms_mean"), 1e3);
  EXPECT_THAT(Bench("'" + path + "'").output, HasSubstr("GOSPA mean"));
  std::filesystem::remove(path);
}

// The published files, where they are at hand: identity only, the accuracy stands in docs.
TEST(V2vouchBenchTracker, PublishedFilesHaveNoFalseTrackAndNoSwitch) {
  const std::string folder = (v2vouch::DataFolder() / "bench/").string();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference data at " << folder;
  for (const char* n : {"10", "50", "100", "200"}) {
    const Finished run = Bench("'" + folder + "scen_rot_" + n + ".csv.gz' --json");
    ASSERT_EQ(run.code, 0) << run.output;
    EXPECT_EQ(Value(run.output, "false_tracks"), 0.0) << n;
    EXPECT_EQ(Value(run.output, "switches"), 0.0) << n;
    EXPECT_LE(Value(run.output, "rmse_m"), 0.28) << n;
  }
}

}  // namespace
}  // namespace v2vouch::bench
