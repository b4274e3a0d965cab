// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch {
namespace {

using ::testing::HasSubstr;

class Csv : public ::testing::Test {
 protected:
  Csv() {
    std::string error;
    const auto writer = LogWriter::Create(path_, error);
    radar_scan_t scan{};
    scan.utime = 7;
    scan.sensor = "a \"b\", c";
    scan.num_detections = 2;
    scan.detections.resize(2);
    scan.detections[0].range_m = 0.1;
    scan.detections[1].range_m = std::nan("");
    scan.detections[1].track_id = -3;
    std::vector<std::uint8_t> bytes;
    wire::Encode(scan, bytes);
    writer->Write(FromMicros(1000), "RADAR_FRONT", bytes);
    bytes.pop_back();  // Damaged: left out.
    writer->Write(FromMicros(1001), "RADAR_FRONT", bytes);
    EXPECT_TRUE(writer->Close(error));
  }
  ~Csv() override { std::filesystem::remove(path_); }
  // The table, or what is wrong.
  std::string Table(const std::string& channel, const std::vector<std::string>& fields) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* out = open_memstream(&text, &size);
    std::string error;
    const auto table = WriteCsv(path_, channel, fields, out, error);
    std::fclose(out);
    const std::unique_ptr<char, decltype(&std::free)> owned(text, &std::free);
    if (table) told_ = *table;
    return table ? std::string(text, size) : error;
  }
  CsvTable told_;
  std::string path_ = ::testing::TempDir() + "csv_test.lcm";
};

TEST_F(Csv, AllPlainFieldsWithoutBeingTold) {
  EXPECT_EQ(Table("RADAR_FRONT", {}),
            "recorded_utime,utime,seq,sensor,num_detections\n1000,7,0,\"a \"\"b\"\", c\",2\n");
}

TEST_F(Csv, TellsWhatIsNotInTheTable) {
  const std::string whole = Table("RADAR_FRONT", {});
  EXPECT_EQ(told_.rows, 1);
  EXPECT_EQ(told_.unreadable, 1);
  EXPECT_EQ(told_.damaged, 0);
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_EQ(Table("RADAR_FRONT", {}), whole);
  EXPECT_EQ(told_.unreadable, 0);
  EXPECT_EQ(told_.damaged, 1);
}

TEST_F(Csv, AListMakesARowPerElementAndNumbersAreExact) {
  EXPECT_EQ(Table("RADAR_FRONT", {"utime", "detections.range_m", "detections.track_id"}),
            "recorded_utime,utime,detections.range_m,detections.track_id\n1000,7,0.1,0\n"
            "1000,7,nan,-3\n");
  EXPECT_EQ(Table("RADAR_FRONT", {"detections[1].track_id", "detections[5].track_id"}),
            "recorded_utime,detections[1].track_id,detections[5].track_id\n1000,-3,\n");
}

TEST_F(Csv, NamesWhatWasProbablyMeant) {
  EXPECT_THAT(Table("RADAR_FRONT", {"detections.rnage_m"}), HasSubstr("did you mean range_m"));
  EXPECT_THAT(Table("RADAR_FORNT", {}), HasSubstr("did you mean RADAR_FRONT"));
  EXPECT_THAT(Table("RADAR_FRONT", {"detections"}), HasSubstr("detections.range_m"));
  EXPECT_THAT(Table("RADAR_FRONT", {"utime.x"}), HasSubstr("nothing is below utime"));
  EXPECT_THAT(Table("RADAR_FRONT", {"detections[x].range_m"}), HasSubstr("no index"));
}

}  // namespace
}  // namespace v2vouch
