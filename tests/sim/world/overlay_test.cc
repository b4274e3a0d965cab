// SPDX-License-Identifier: Apache-2.0
#include "sim/world/overlay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace v2vouch::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OverlayFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("v2vouch_overlay_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    ASSERT_TRUE(LoadScenario("sim/scenarios/smoke.yaml", scenario_, problems_));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  bool Lay(const std::string& name, const std::string& text) {
    const auto path = folder_ / name;
    std::ofstream(path) << text;
    return LayOver(path.string(), scenario_, problems_);
  }

  std::filesystem::path folder_;
  Scenario scenario_;
  std::vector<std::string> problems_;
};

TEST_F(OverlayFile, ReplacesKeysAppendsListsAndKeepsTheScenariosName) {
  const std::size_t vehicles = scenario_.vehicles.size();
  const double rate = scenario_.bsm.rate_hz;
  ASSERT_TRUE(Lay("H04_loss.yaml",
                  "description: half is lost\n"
                  "radio: {base_loss: 0.5}\n"
                  "vehicles: [{id: 77, drive: {route: " +
                      scenario_.routes[0].name + "}}]\n"));
  EXPECT_EQ(scenario_.name, "smoke");
  EXPECT_EQ(scenario_.radio.base_loss, 0.5);
  EXPECT_EQ(scenario_.bsm.rate_hz, rate);
  ASSERT_EQ(scenario_.vehicles.size(), vehicles + 1);
  EXPECT_EQ(scenario_.vehicles.back().id, 77u);
  EXPECT_TRUE(CheckReferences(scenario_, problems_));
  ASSERT_TRUE(Lay("mine.yaml", "name: X1/second\nradio: {half_range_m: 90}\n"));
  EXPECT_THAT(scenario_.overlays, ElementsAre("H4/loss", "X1/second"));
  EXPECT_EQ(scenario_.radio.base_loss, 0.5);
  EXPECT_EQ(scenario_.radio.half_range_m, 90.0);
}

TEST_F(OverlayFile, ATakenIdAndAnUnknownKeyAreNamed) {
  ASSERT_TRUE(Lay("a.yaml", "vehicles: [{id: " + std::to_string(scenario_.vehicles[0].id) +
                                ", drive: {route: nowhere}}]\n"));
  EXPECT_FALSE(CheckReferences(scenario_, problems_));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("id is taken"), HasSubstr("'nowhere'")));
  problems_.clear();
  EXPECT_FALSE(Lay("b.yaml", "radio: {base_los: 0.5}\n"));
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("b.yaml:1: radio.base_los: unknown key")));
  EXPECT_FALSE(LayOver((folder_ / "nosuch.yaml").string(), scenario_, problems_));
}

TEST_F(OverlayFile, OneThatSuitsAnotherScenarioIsRefused) {
  EXPECT_FALSE(Lay("c.yaml", "suits: [urban, highway]\nradio: {base_loss: 0.9}\n"));
  EXPECT_THAT(problems_,
              ElementsAre(HasSubstr("does not suit scenario smoke, but urban, highway")));
  EXPECT_NE(scenario_.radio.base_loss, 0.9);
  EXPECT_TRUE(Lay("d.yaml", "suits: [smoke]\nradio: {base_loss: 0.9}\n"));
}

TEST(OverlayName, IsTheIdAndTheVariant) {
  EXPECT_EQ(OverlayName("x/A05_lateral_8m.yaml"), "A5/lateral_8m");
  EXPECT_EQ(OverlayName("H11_dense.yaml"), "H11/dense");
  EXPECT_EQ(OverlayName("B05_x.yaml"), "B05_x");
  EXPECT_EQ(OverlayName("my_attack.yaml"), "my_attack");
}

}  // namespace
}  // namespace v2vouch::sim
