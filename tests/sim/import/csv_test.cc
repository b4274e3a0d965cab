// SPDX-License-Identifier: Apache-2.0
#include "sim/import/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/sim/import/files.h"

namespace v2vouch::sim {
namespace {

using testing::HasSubstr;

class Csv : public testing::Test {
 protected:
  std::unique_ptr<CsvReader> Open(const std::string& text) {
    return CsvReader::Open(folder_.Write("t.csv", text), {"b", "a"}, error_);
  }
  ScratchFolder folder_{"csv"};
  std::string error_;
};

TEST_F(Csv, ColumnsComeInTheOrderAskedForWhateverTheFileHas) {
  const auto csv = Open("a,x,b\r\n1,junk,2.5\r\n\r\n-3e2,,4\n");
  ASSERT_NE(csv, nullptr) << error_;
  ASSERT_TRUE(csv->Next());
  EXPECT_EQ(csv->Number(0), 2.5);
  EXPECT_EQ(csv->Number(1), 1.0);
  ASSERT_TRUE(csv->Next());
  EXPECT_EQ(csv->Text(1), "-3e2");
  EXPECT_EQ(csv->Number(1), -300.0);
  EXPECT_FALSE(csv->Next());
  EXPECT_EQ(csv->error(), "");
}

TEST_F(Csv, ALastLineWithoutNewlineCounts) {
  const auto csv = Open("a,b\n1,2");
  ASSERT_NE(csv, nullptr);
  EXPECT_TRUE(csv->Next());
  EXPECT_EQ(csv->Number(0), 2.0);
}

TEST_F(Csv, AMissingColumnIsNamedWithTheHeaderThatIsThere) {
  EXPECT_EQ(Open("time,b\n1,2\n"), nullptr);
  EXPECT_THAT(error_, HasSubstr("lacks the column(s) a"));
  EXPECT_THAT(error_, HasSubstr("time,b"));
}

TEST_F(Csv, ABadNumberNamesFileLineColumnAndText) {
  const auto csv = Open("a,b\n1,2\n1,two\n");
  ASSERT_NE(csv, nullptr);
  EXPECT_TRUE(csv->Next());
  EXPECT_TRUE(csv->Next());
  csv->Number(0);
  EXPECT_THAT(csv->error(), HasSubstr("t.csv:3: b = \"two\" is not a number"));
  EXPECT_FALSE(csv->Next());
}

TEST_F(Csv, NumbersThatAreNotFiniteOrOnlyBeginAsNumbersAreFaults) {
  for (const std::string bad : {"nan", "inf", "1.5x", "", "1e999", "0x10", "1 2"}) {
    const auto csv = Open("a,b\n1," + bad + "\n");
    ASSERT_TRUE(csv->Next()) << bad;
    csv->Number(0);
    EXPECT_NE(csv->error(), "") << bad;
  }
}

TEST_F(Csv, ARowWithTooFewOrTooManyFieldsIsAFault) {
  for (const std::string row : {"1", "1,2,3"}) {
    const auto csv = Open("a,b\n" + row + "\n");
    EXPECT_FALSE(csv->Next());
    EXPECT_THAT(csv->error(), HasSubstr(":2: has "));
  }
}

TEST_F(Csv, AnEndlessLineIsRefused) {
  EXPECT_EQ(Open(std::string(1 << 20, 'x')), nullptr);
  EXPECT_THAT(error_, HasSubstr("line is too long"));
}

TEST_F(Csv, MissingAndEmptyFilesSaySo) {
  EXPECT_EQ(CsvReader::Open(folder_.path() + "/none.csv", {"a"}, error_), nullptr);
  EXPECT_THAT(error_, HasSubstr("cannot be opened"));
  EXPECT_EQ(Open(""), nullptr);
  EXPECT_THAT(error_, HasSubstr("is empty"));
}

TEST_F(Csv, GzipIsReadAndATruncatedOneIsAFault) {
  const std::string path = folder_.path() + "/t.csv.gz";
  std::string text = "a,b\n";
  for (int k = 0; k < 5000; ++k) text += std::to_string(k * 7919 % 10007) + ",2\n";
  gzFile file = gzopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  ASSERT_EQ(gzwrite(file, text.data(), static_cast<unsigned>(text.size())),
            static_cast<int>(text.size()));
  ASSERT_EQ(gzclose(file), Z_OK);
  const auto read_all = [&] {
    const auto csv = CsvReader::Open(path, {"a"}, error_);
    int rows = 0;
    while (csv->Next()) ++rows;
    error_ = csv->error();
    return rows;
  };
  EXPECT_EQ(read_all(), 5000);
  EXPECT_EQ(error_, "");
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_LT(read_all(), 5000);
  EXPECT_THAT(error_, HasSubstr("cannot be read further"));
}

}  // namespace
}  // namespace v2vouch::sim
