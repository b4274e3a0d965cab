// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/input_watch.h"

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

void Take(InputWatch& watch, std::size_t channel, double at_s, std::int64_t seq) {
  watch.Received(channel, At(at_s));
  watch.Accepted(channel, At(at_s), seq);
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
  for (const int seq : {10, 11, 14, 15}) Take(watch, 0, 0.1 * seq, seq);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 2);
  Take(watch, 0, 1.2, 12);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 1);
  Take(watch, 0, 1.6, 16);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 1);
}

TEST(InputWatch, ACounterThatStartsAgainOrStandsOrIsShortLostNothing) {
  InputWatch watch(kChannels);
  Take(watch, 0, 0.0, 5'000'000);
  Take(watch, 0, 0.1, 0);
  Take(watch, 0, 0.2, 1);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
  Take(watch, 0, 0.3, INT64_MAX);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
  for (int i = 0; i < 40; ++i) Take(watch, 0, 1.0 + 0.05 * i, i % 4);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
  for (int i = 0; i < 40; ++i) Take(watch, 0, 4.0 + 0.05 * i, 0);
  EXPECT_EQ(ReportOf(watch, 0).gaps, 0);
}

TEST(InputWatch, RateIsPerSecondOfArrivalAndSilenceIsThreePeriods) {
  InputWatch watch(kChannels);
  Take(watch, 0, 0.0, 0);
  static_cast<void>(ReportOf(watch, 0));
  Take(watch, 1, 0.0, 0);
  for (int i = 1; i <= 20; ++i) Take(watch, 0, 0.05 * i, i);
  std::vector<wire::InputStatus> inputs;
  watch.Report(inputs);
  EXPECT_NEAR(inputs[0].rate_hz, 20.0, 1e-9);
  EXPECT_FALSE(inputs[0].is_silent);
  EXPECT_NEAR(inputs[1].age_s, 1.0, 1e-9);
  watch.AdvanceTo(At(1.151));
  EXPECT_TRUE(ReportOf(watch, 0).is_silent);
}

// A sensor whose stamps are an hour ahead neither looks dead nor makes the others look dead.
TEST(InputWatch, StampsSayNothingAboutWhoIsAlive) {
  const std::array<wire::InputChannel, 2> two = {kChannels[0],
                                                 {"EGO", wire::InputKind::kEgoMotion, 0, 0.05}};
  InputWatch watch(two);
  for (int i = 0; i < 40; ++i) {
    watch.Received(0, At(0.05 * i));
    watch.Accepted(0, At(0.05 * i + 3600.0), i);
    watch.Received(1, At(0.05 * i));  // Refused.
  }
  EXPECT_FALSE(ReportOf(watch, 0).is_silent);
  EXPECT_FALSE(ReportOf(watch, 1).is_silent);
  EXPECT_NEAR(ReportOf(watch, 1).age_s, 0.0, 1e-9);
}

TEST(InputWatch, WhoIsSilentForASecondIsWorthANotice) {
  InputWatch watch(kChannels);
  Take(watch, 1, 0.0, 0);
  std::vector<Notice> notices;
  watch.CollectNotices(notices);
  EXPECT_TRUE(notices.empty());
  watch.AdvanceTo(At(1.5));  // The radar was never heard.
  watch.CollectNotices(notices);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind, NoticeKind::kInputSilent);
  EXPECT_EQ(notices[0].subject, (NoticeSubject{NoticeSubject::Kind::kRadar, 0}));
  EXPECT_NEAR(notices[0].value, 1.5, 1e-9);
}

// The host's clock was set while a log was recorded.
TEST(InputWatch, ArrivalThatLeapsOrGoesBackDoesNoHarm) {
  InputWatch watch(kChannels);
  Take(watch, 0, 0.0, 0);
  Take(watch, 0, -86400.0, 1);
  Take(watch, 0, -86399.95, 2);
  EXPECT_NEAR(ToSeconds(watch.elapsed()), 0.05, 1e-9);
  Take(watch, 0, 3e7, 3);
  EXPECT_LE(ToSeconds(watch.elapsed()), 0.05 + InputWatch::kLongestLeap_s);
}

}  // namespace
}  // namespace v2vouch
