// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/did_you_mean.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const std::vector<std::string> kChannels = {"RADAR_FRONT", "RADAR_FRONT_LEFT", "CAMERA_FRONT",
                                            "EGO_MOTION", "BSM"};

TEST(DidYouMean, SwappedMissingExtraAndWrongLettersAreForgiven) {
  for (const char* typo :
       {"RADAR_FORNT", "RADAR_FRON", "RADARFRONT", "RADAR_FRRONT", "radar_front", "RADAR-FRONT"}) {
    EXPECT_EQ(DidYouMean(typo, kChannels), " (did you mean RADAR_FRONT?)") << typo;
  }
  EXPECT_EQ(DidYouMean("BMS", kChannels), " (did you mean BSM?)");
  EXPECT_EQ(DidYouMean("EGOMOTION", kChannels), " (did you mean EGO_MOTION?)");
}

TEST(DidYouMean, WhatIsFarFromAllNamesOrKnownGetsNoSuggestion) {
  EXPECT_EQ(DidYouMean("LIDAR_TOP", kChannels), "");
  EXPECT_EQ(DidYouMean("XYZ", kChannels), "");
  EXPECT_EQ(DidYouMean("", kChannels), "");
  EXPECT_EQ(DidYouMean("BSM", kChannels), "");
  EXPECT_EQ(DidYouMean("anything", std::vector<std::string>{}), "");
  EXPECT_EQ(DidYouMean(std::string(100'000, 'R'), kChannels), "");
}

TEST(Listed, LongListsAreCutWithTheirLength) {
  EXPECT_EQ(Listed({}), "");
  EXPECT_EQ(Listed({"a", "b"}), "a, b");
  EXPECT_EQ(Listed({"a", "b", "c"}, 2), "a, b, ... (3 in all)");
}

}  // namespace
}  // namespace v2vouch
