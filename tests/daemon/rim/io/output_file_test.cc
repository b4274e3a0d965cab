// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "daemon/rim/io/durable_file.h"
#include "daemon/rim/io/event_log.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputFile : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(Path("kept")) << "kept";
  }
  void TearDown() override {
    std::ifstream file(Path("kept"));
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "kept");
    fs::remove_all(folder_);
  }
  [[nodiscard]] std::string Path(const std::string& name) const { return folder_ / name; }
  // Both ways of writing refuse, with the same words.
  void ExpectRefused(const std::string& path, const std::string& words,
                     const std::vector<std::string>& inputs = {}) {
    std::string error;
    EXPECT_FALSE(ReplaceFile(path, "x", error, inputs));
    EXPECT_THAT(error, HasSubstr(words));
    EXPECT_THAT(error, HasSubstr(path));
    error.clear();
    EXPECT_FALSE(LogWriter::Create(path, error, inputs));
    EXPECT_THAT(error, HasSubstr(words));
  }
  const fs::path folder_ = fs::path(testing::TempDir()) / "output_file_test";
};

TEST_F(OutputFile, ADeviceIsWrittenIntoAndStaysADevice) {
  std::string error;
  EXPECT_TRUE(ReplaceFile("/dev/null", "x", error)) << error;
  const auto writer = LogWriter::Create("/dev/null", error);
  ASSERT_TRUE(writer) << error;
  EXPECT_TRUE(writer->Close(error)) << error;
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_FALSE(ReplaceFile("/dev/full", "x", error));
  EXPECT_THAT(error, HasSubstr("/dev/full: cannot write: No space left"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  for (const auto& entry : fs::directory_iterator("/dev")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("null.")) << entry.path();
  }
}

TEST_F(OutputFile, AFullDeviceIsNoticedWhileALogIsWritten) {
  std::string error;
  const auto writer = LogWriter::Create("/dev/full", error);
  ASSERT_TRUE(writer) << error;
  const std::vector<std::uint8_t> bytes(1 << 20);
  writer->Write(Timestamp{}, "A", bytes);
  EXPECT_FALSE(writer->is_good());
  EXPECT_FALSE(writer->Close(error));
  EXPECT_THAT(error, HasSubstr("/dev/full: No space left"));
}

TEST_F(OutputFile, APipeThatNobodyReadsIsAnErrorAndStaysAPipe) {
  ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
  ExpectRefused(Path("pipe"), "is a pipe that nobody reads");
  EXPECT_TRUE(fs::is_fifo(Path("pipe")));
  std::string error;
  EXPECT_FALSE(LogReader::Open(Path("pipe"), error));  // Does not wait either.
  EXPECT_THAT(error, HasSubstr("is not a file"));
}

TEST_F(OutputFile, ASymbolicLinkToAFileIsNotFollowedAndNotReplaced) {
  fs::create_symlink(Path("kept"), Path("link"));
  ExpectRefused(Path("link"), "is a symbolic link to " + Path("kept"));
  EXPECT_TRUE(fs::is_symlink(Path("link")));
  fs::create_symlink("nothing", Path("dangling"));
  ExpectRefused(Path("dangling"), "is a symbolic link to nothing, which is not there");
  EXPECT_FALSE(fs::exists(Path("nothing")));
}

TEST_F(OutputFile, ALinkToADeviceIsFollowed) {
  fs::create_symlink("/dev/null", Path("link"));
  std::string error;
  EXPECT_TRUE(ReplaceFile(Path("link"), "x", error)) << error;
  EXPECT_TRUE(fs::is_symlink(Path("link")));
}

TEST_F(OutputFile, WhatIsBeingReadIsNotOverwrittenUnderWhateverName) {
  const std::vector<std::string> inputs = {Path("none"), Path("kept")};
  ExpectRefused(Path("kept"), "is the file that is being read", inputs);
  fs::create_hard_link(Path("kept"), Path("other_name"));
  ExpectRefused(Path("other_name"), "is the file that is being read", inputs);
}

TEST_F(OutputFile, FoldersAreRefusedAndMissingOnesNamed) {
  fs::create_directories(Path("folder"));
  ExpectRefused(Path("folder"), "is a folder");
  ExpectRefused(Path("none/a.lcm"), "cannot write in folder " + Path("none") + ": No such file");
  ExpectRefused("/proc/a.lcm", "/proc");
}

}  // namespace
}  // namespace v2vouch
