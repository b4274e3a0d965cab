// SPDX-License-Identifier: Apache-2.0
#include "daemon/assembly/input_watch.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace v2vouch {
namespace {

const std::array<wire::InputChannel, 2> kChannels = {
    wire::InputChannel{"RADAR_FRONT", wire::InputKind::kRadar, 0, 0.05},
    wire::InputChannel{"BSM", wire::InputKind::kBsm, 0, 0.0}};

Timestamp At(double seconds) { return FromMicros(1'700'000'000'000'000) + FromSeconds(seconds); }

wire::InputStatus ReportOf(InputWatch& watch, std::size_t channel) {
  std::vector<wire::InputStatus> inputs;
  watch.Report(inputs);
  return inputs.at(channel);
}

TEST(InputWatch, NothingHeardHasNoAgeAndIsSilent) {
  InputWatch watch(kChannels);
  const auto status = ReportOf(watch, 0);
  EXPECT_TRUE(std::isnan(status.age_s));
  EXPECT_TRUE(status.is_silent);
  EXPECT_FALSE(ReportOf(watch, 1).is_silent);  // Nobody has to send BSMs.
}

TEST(InputWatch, LossesAreCountedAndLateOnesTakenBack) {
  InputWatch watch(kChannels);
  for (const std::int64_t seq : {10, 11, 14, 15}) watch.Accepted(0, At(0.0), seq);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 2);
  watch.Accepted(0, At(0.0), 12);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 1);
  watch.Accepted(0, At(0.0), 16);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 1);
}

TEST(InputWatch, SenderThatStartsAgainLostNothing) {
  InputWatch watch(kChannels);
  watch.Accepted(0, At(0.0), 5'000'000);
  watch.Accepted(0, At(0.1), 0);
  watch.Accepted(0, At(0.2), 1);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
  watch.Accepted(0, At(0.3), INT64_MAX);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
}

TEST(InputWatch, RateIsPerSecondOfMessageTimeAndSilenceIsThreePeriods) {
  InputWatch watch(kChannels);
  watch.Accepted(0, At(0.0), 0);
  static_cast<void>(ReportOf(watch, 0));
  for (int i = 1; i <= 20; ++i) watch.Accepted(0, At(0.05 * i), i);
  watch.Accepted(1, At(0.2), 0);
  std::vector<wire::InputStatus> inputs;
  watch.Report(inputs);
  EXPECT_NEAR(inputs[0].rate_hz, 20.0, 1e-9);
  EXPECT_FALSE(inputs[0].is_silent);
  EXPECT_NEAR(inputs[1].age_s, 0.8, 1e-9);

  const std::array<wire::InputChannel, 2> two = {kChannels[0],
                                                 {"EGO", wire::InputKind::kEgoMotion, 0, 0.05}};
  InputWatch both(two);
  both.Accepted(0, At(0.0), 0);
  both.Accepted(1, At(0.151), 0);
  EXPECT_TRUE(ReportOf(both, 0).is_silent);
  EXPECT_FALSE(ReportOf(both, 1).is_silent);
}

}  // namespace
}  // namespace v2vouch
