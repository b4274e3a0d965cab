// SPDX-License-Identifier: Apache-2.0
#include "daemon/trust/standard_classes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace v2vouch {
namespace {

// The names of all checks, read off the places where findings are made.
std::set<std::string> ChecksInTheTree() {
  const std::regex made(
      R"re((?:Finding\{|JudgeResidual\()\s*"([a-z_]+)"|\{"([a-z_]+)",\s*Verdict::)re");
  std::set<std::string> names;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(V2VOUCH_SOURCE_DIR "/daemon")) {
    if (entry.path().extension() != ".cc") continue;
    std::ifstream file(entry.path());
    std::stringstream stream;
    stream << file.rdbuf();
    const std::string text = stream.str();
    for (std::sregex_iterator at(text.begin(), text.end(), made), end; at != end; ++at) {
      names.insert((*at)[1].matched ? (*at)[1].str() : (*at)[2].str());
    }
  }
  return names;
}

TEST(StandardClasses, EveryCheckInTheTreeHasItsRow) {
  const std::set<std::string> names = ChecksInTheTree();
  EXPECT_GE(names.size(), 20U);
  for (const std::string& name : names) {
    EXPECT_TRUE(StandardClassOf(name)) << name << " is missing in standard_classes.cc";
  }
  EXPECT_FALSE(StandardClassOf("no_such_check"));
}

TEST(StandardClasses, ObservationsThatTheStandardListsHaveItsClass) {
  EXPECT_EQ(StandardClassOf("message_rate")->etsi_class, 0);
  EXPECT_EQ(StandardClassOf("size_change")->etsi_class, 1);
  EXPECT_EQ(StandardClassOf("position_jump")->etsi_class, 3);
  EXPECT_EQ(StandardClassOf("implausible_motion")->etsi_class, 4);
  EXPECT_EQ(StandardClassOf("acceleration_residual")->etsi_class, 5);
  EXPECT_EQ(StandardClassOf("contested_identity")->etsi_class, -1);
  EXPECT_FALSE(StandardClassOf("position_jump")->is_j3287);
}

}  // namespace
}  // namespace v2vouch
