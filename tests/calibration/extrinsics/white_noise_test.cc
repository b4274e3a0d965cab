// SPDX-License-Identifier: Apache-2.0
#include "calibration/extrinsics/white_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "daemon/common/base/random.h"

namespace v2vouch {
namespace {

TEST(WhiteSigma, IsBlindToASmoothSignalAndNeedsTwentyValues) {
  Random random(9);
  std::vector<double> signal;
  for (int i = 0; i < 5000; ++i) {
    signal.push_back(20.0 * std::sin(0.01 * i) + random.Normal(0.0, 0.3));
  }
  EXPECT_NEAR(WhiteSigma(signal), 0.3, 0.015);
  signal.resize(19);
  EXPECT_TRUE(std::isnan(WhiteSigma(signal)));
}

TEST(WhiteSigmaWithin, BelievesTheSignalWithinWhatIsStated) {
  Random random(10);
  std::vector<double> signal;
  for (int i = 0; i < 5000; ++i) signal.push_back(random.Normal(0.0, 0.3));
  EXPECT_EQ(WhiteSigmaWithin(signal, {0.5, 0.5, 9.0}, 0.1), WhiteSigma(signal));
  EXPECT_EQ(WhiteSigmaWithin(signal, {2.0}, 0.1), 0.5);
  EXPECT_EQ(WhiteSigmaWithin(signal, {0.2}, 0.1), 0.2);
  EXPECT_EQ(WhiteSigmaWithin({}, {0.2}, 0.1), 0.2);
  EXPECT_EQ(WhiteSigmaWithin(signal, {}, 0.1), 0.1);
  EXPECT_EQ(WhiteSigmaWithin({}, {0.0}, 0.1), 0.1);
}

}  // namespace
}  // namespace v2vouch
