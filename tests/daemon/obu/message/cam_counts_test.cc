// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "daemon/obu/message/bsm_message.h"

namespace v2vouch::obu {
namespace {

TEST(CamCounts, CountOneByOneWhateverTheIntervalAndCopiesTheSame) {
  CamCounts counts;
  Cam cam;
  cam.station_id = 7;
  for (int i = 0; i < 300; ++i) {
    cam.generation_delta_time = i * 1000 % 65536;
    EXPECT_EQ(counts.CountOf(cam), i % 128);
    EXPECT_EQ(counts.CountOf(cam), i % 128);  // The other antenna.
  }
}

TEST(CamCounts, FloodOfStationsIsBoundedAndForgetsTheOldest) {
  CamCounts counts;
  Cam steady;
  steady.station_id = 1;
  for (int i = 0; i < 20000; ++i) {
    Cam cam;
    cam.station_id = 1000U + static_cast<std::uint32_t>(i);
    EXPECT_EQ(counts.CountOf(cam), 0);
    if (i % 100 == 0) {
      steady.generation_delta_time = i;
      EXPECT_EQ(counts.CountOf(steady), i / 100 % 128);
    }
  }
}

}  // namespace
}  // namespace v2vouch::obu
