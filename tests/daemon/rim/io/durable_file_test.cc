// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/durable_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReplaceFileTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  static std::string TextOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] std::ptrdiff_t FileCount() const {
    return std::distance(fs::directory_iterator(folder_), {});
  }
  const fs::path folder_ = fs::path(testing::TempDir()) / "durable_file_test";
  const fs::path path_ = folder_ / "a.yaml";
  std::string error_;
};

TEST_F(ReplaceFileTest, WritesANewFileAndReplacesAnOldOneLeavingNothingElse) {
  const std::string large(300'000, '\0');
  ASSERT_TRUE(ReplaceFile(path_.string(), "old", error_)) << error_;
  EXPECT_EQ(TextOf(path_), "old");
  ASSERT_TRUE(ReplaceFile(path_.string(), large, error_)) << error_;
  EXPECT_EQ(TextOf(path_), large);
  EXPECT_EQ(FileCount(), 1);
  struct stat status {};
  ASSERT_EQ(stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0644u);
}

// Who has the old file open goes on reading the old one: it is replaced, never overwritten.
TEST_F(ReplaceFileTest, AReaderOfTheOldFileIsNotDisturbed) {
  ASSERT_TRUE(ReplaceFile(path_.string(), "old content", error_));
  std::ifstream reader(path_);
  ASSERT_TRUE(ReplaceFile(path_.string(), "new", error_));
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(reader), {}), "old content");
}

TEST_F(ReplaceFileTest, WhatCannotBeWrittenIsNamedAndLeavesNothing) {
  EXPECT_FALSE(ReplaceFile((folder_ / "none" / "a.yaml").string(), "x", error_));
  EXPECT_THAT(error_, HasSubstr("cannot write in folder"));
  fs::create_directories(folder_ / "a_folder" / "full");
  EXPECT_FALSE(ReplaceFile((folder_ / "a_folder").string(), "x", error_));
  EXPECT_THAT(error_, HasSubstr("is a folder"));
  EXPECT_EQ(FileCount(), 1);
}

}  // namespace
}  // namespace v2vouch
