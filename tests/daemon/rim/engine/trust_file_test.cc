// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/trust_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TrustFile Example(std::size_t senders = 3) {
  TrustFile file;
  file.vehicle = "car 7";
  file.saved = FromMicros(1'700'000'000'000'000);
  for (std::size_t i = 0; i < senders; ++i) {
    file.senders.push_back({.sender = static_cast<SenderId>(0x10 + i),
                            .certificate = {1, 2, 3, 4, 5, 6, 7, static_cast<std::uint8_t>(i)},
                            .state = i % 3 == 0   ? TrustState::kRevoked
                                     : i % 3 == 1 ? TrustState::kSuspect
                                                  : TrustState::kCandidate,
                            .suspicions = 2,
                            .accusations = 1,
                            .since_s = 12.5,
                            .finding_s = 3.25});
  }
  return file;
}

class TrustFileTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void Save(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  [[nodiscard]] LoadedTrust LoadAfter(double seconds, const std::string& vehicle = "car 7") const {
    return LoadTrust(path_, vehicle, Example().saved + FromSeconds(seconds), 3600.0);
  }
  const fs::path folder_ = fs::path(testing::TempDir()) / "trust_file_test";
  const std::string path_ = folder_ / "trust.state";
};

TEST_F(TrustFileTest, WhatIsPrintedIsReadBack) {
  std::string problem;
  const auto read = ParseTrust(PrintTrust(Example()), problem);
  ASSERT_TRUE(read) << problem;
  EXPECT_EQ(read->vehicle, "car 7");
  EXPECT_EQ(read->saved, Example().saved);
  ASSERT_EQ(read->senders.size(), 3u);
  EXPECT_EQ(read->senders[1].sender, 0x11u);
  EXPECT_EQ(read->senders[1].certificate, Example().senders[1].certificate);
  EXPECT_EQ(read->senders[1].state, TrustState::kSuspect);
  EXPECT_EQ(read->senders[1].suspicions, 2);
  EXPECT_EQ(read->senders[1].accusations, 1);
  EXPECT_DOUBLE_EQ(read->senders[1].since_s, 12.5);
  EXPECT_DOUBLE_EQ(read->senders[1].finding_s, 3.25);
}

TEST_F(TrustFileTest, AgesGrowByTheTimeItLay) {
  EXPECT_TRUE(LoadAfter(0.0).problem.empty());  // None there yet is no problem.
  Save(PrintTrust(Example()));
  const LoadedTrust loaded = LoadAfter(100.0);
  EXPECT_EQ(loaded.problem, "");
  ASSERT_EQ(loaded.senders.size(), 3u);
  EXPECT_DOUBLE_EQ(loaded.senders[0].since_s, 112.5);
  EXPECT_DOUBLE_EQ(loaded.senders[0].finding_s, 103.25);
}

TEST_F(TrustFileTest, TooOldOrAnotherCarsGivesNothing) {
  Save(PrintTrust(Example()));
  EXPECT_TRUE(LoadAfter(3601.0).senders.empty());
  EXPECT_THAT(LoadAfter(3601.0).problem, HasSubstr("is 3601 s old; at most 3600 s"));
  EXPECT_TRUE(
      LoadAfter(3599.0).senders.empty());  // The file is young enough, the findings are not.
  EXPECT_TRUE(LoadAfter(1.0, "car 8").senders.empty());
  EXPECT_THAT(LoadAfter(1.0, "car 8").problem, HasSubstr("is of vehicle \"car 7\""));
}

// The clock was set back: nobody's penalty ends by that, nobody is relied on by it.
TEST_F(TrustFileTest, FromTheFutureOnlyPenaltiesAreTaken) {
  Save(PrintTrust(Example()));
  const LoadedTrust loaded = LoadAfter(-1e6);
  ASSERT_EQ(loaded.senders.size(), 2u);
  EXPECT_DOUBLE_EQ(loaded.senders[0].since_s, 12.5);
}

TEST_F(TrustFileTest, AnotherVersionIsRefusedAndAForeignFileIsToldApart) {
  std::string problem;
  EXPECT_FALSE(ParseTrust("lcm:\n  url: x\n", problem));
  EXPECT_EQ(problem, "is no trust file");
  Save("lcm:\n  url: x\n");
  EXPECT_TRUE(LoadAfter(1.0).is_foreign);
  Save(PrintTrust(Example()).substr(0, 100));
  EXPECT_FALSE(LoadAfter(1.0).is_foreign);
  EXPECT_THAT(LoadAfter(1.0).problem, HasSubstr("its checksum does not fit"));
  Save("");
  EXPECT_FALSE(LoadAfter(1.0).is_foreign);
  EXPECT_NE(LoadAfter(1.0).problem, "");
  fs::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_TRUE(LoadAfter(1.0).is_foreign);  // And does not wait for a writer.
}

TEST_F(TrustFileTest, NoDamageIsReadAsSomethingElse) {
  const std::string good = PrintTrust(Example(20));
  std::string problem;
  for (std::size_t length = 0; length < good.size(); ++length) {
    EXPECT_FALSE(ParseTrust(good.substr(0, length), problem)) << length;
  }
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = good;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      EXPECT_FALSE(ParseTrust(damaged, problem)) << i << " " << bit;
    }
  }
  Random random(17);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string noise = "v2vouch-trust 1\n";
    const auto size = random.Bits() % 400;
    for (std::uint64_t i = 0; i < size; ++i) noise += static_cast<char>(random.Bits());
    EXPECT_FALSE(ParseTrust(noise, problem));
  }
}

// Sealed by somebody, but nonsense: bounded and refused.
TEST_F(TrustFileTest, ASealedFileOfNonsenseIsRefused) {
  std::string problem;
  TrustFile file = Example(kMostTrustMemories + 1);
  EXPECT_FALSE(ParseTrust(PrintTrust(file), problem));
  file = Example(1);
  file.senders[0].suspicions = -5;
  EXPECT_FALSE(ParseTrust(PrintTrust(file), problem));
  file = Example(1);
  file.vehicle = "two\nlines";
  EXPECT_FALSE(ParseTrust(PrintTrust(file), problem));
  file = Example(kMostTrustMemories);
  EXPECT_TRUE(ParseTrust(PrintTrust(file), problem)) << problem;
  EXPECT_LT(PrintTrust(file).size(), kMostTrustFileBytes);
}

}  // namespace
}  // namespace v2vouch
