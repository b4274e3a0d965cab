// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/program/shipped_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace v2vouch {
namespace {

namespace fs = std::filesystem;

TEST(ShippedFolder, LiesBesideTheProgramInABuildTreeToo) {
  unsetenv("V2VOUCH_SHARE");
  for (const char* name : {"scenarios", "attacks", "config", "lcmtypes"}) {
    EXPECT_TRUE(fs::is_directory(ShippedFolder(name))) << ShippedFolder(name);
  }
  EXPECT_TRUE(fs::exists(ShippedFolder("config") / "vehicle_paper.yaml"));
}

TEST(ShippedFolder, TheEnvironmentGoesFirstAndAnEmptyVariableDoesNotCount) {
  setenv("V2VOUCH_SHARE", "/somewhere/else", 1);
  EXPECT_EQ(ShippedFolder("config"), "/somewhere/else/config");
  setenv("V2VOUCH_SHARE", "", 1);
  EXPECT_TRUE(fs::is_directory(ShippedFolder("config")));
  unsetenv("V2VOUCH_SHARE");
}

TEST(ShippedFolder, WhereItIsNotTheWordsSayWhereItWasLookedForAndWhatToDo) {
  unsetenv("V2VOUCH_SHARE");
  EXPECT_EQ(WhyNotShipped("config"), "");
  setenv("V2VOUCH_SHARE", "/somewhere/else", 1);
  const std::string why = WhyNotShipped("config");
  EXPECT_NE(why.find("/somewhere/else/config"), std::string::npos) << why;
  EXPECT_NE(why.find("V2VOUCH_SHARE"), std::string::npos) << why;
  unsetenv("V2VOUCH_SHARE");
}

}  // namespace
}  // namespace v2vouch
