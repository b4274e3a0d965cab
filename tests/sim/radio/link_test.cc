// SPDX-License-Identifier: Apache-2.0
#include "sim/radio/link.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::sim {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;

struct Counts {
  int heard = 0;
  int interference = 0;
  int copies = 0;
  double signal_dbm = 0.0;  // Mean.
  int overtaken = 0;        // Copies that arrive before one sent earlier.
};

Counts CarryMany(const LinkSpec& spec, double distance_m, bool is_blocked, int messages = 20000) {
  Link link(spec, 3, 1, 2);
  Counts counts;
  std::int64_t latest = 0;
  for (int i = 0; i < messages; ++i) {
    const std::int64_t utime = kStart + i * 100000LL;
    const Link::Outcome outcome = link.Carry(utime, distance_m, is_blocked);
    counts.heard += outcome.fate == Link::Fate::kHeard ? 1 : 0;
    counts.interference += outcome.fate == Link::Fate::kInterference ? 1 : 0;
    for (const Link::Copy& copy : outcome.copies) {
      ++counts.copies;
      counts.signal_dbm += copy.signal_dbm;
      counts.overtaken += utime + copy.delay_us < latest ? 1 : 0;
      latest = std::max(latest, utime + copy.delay_us);
      EXPECT_GE(copy.delay_us, std::llround(spec.delay_s * 1e6));
    }
  }
  counts.signal_dbm /= std::max(counts.copies, 1);
  return counts;
}

TEST(Link, NineOfTenMessagesArriveAtTheNamedRanges) {
  const LinkSpec spec;
  EXPECT_NEAR(CarryMany(spec, spec.open_90_m, false).heard, 18000, 150);
  EXPECT_NEAR(CarryMany(spec, spec.blocked_90_m, true).heard, 18000, 150);
  EXPECT_GT(CarryMany(spec, 20.0, false).heard, 19990);
  EXPECT_LT(CarryMany(spec, 3000.0, false).heard, 50);
  EXPECT_NEAR(ReceptionProbability(spec, spec.open_90_m, false), 0.9, 1e-12);
}

TEST(Link, TheSameSeedGivesTheSameAndAnotherOneAnother) {
  const LinkSpec spec{.duplicate_share = 0.2, .burst_every_s = 5.0};
  Link a(spec, 3, 1, 2), b(spec, 3, 1, 2), c(spec, 4, 1, 2);
  int other = 0;
  for (int i = 0; i < 500; ++i) {
    const auto x = a.Carry(kStart + i * 100000LL, 250.0, false);
    const auto y = b.Carry(kStart + i * 100000LL, 250.0, false);
    const auto z = c.Carry(kStart + i * 100000LL, 250.0, false);
    ASSERT_EQ(x.fate, y.fate);
    ASSERT_EQ(x.copies.size(), y.copies.size());
    for (std::size_t k = 0; k < x.copies.size(); ++k) {
      EXPECT_EQ(x.copies[k].delay_us, y.copies[k].delay_us);
      EXPECT_EQ(x.copies[k].signal_dbm, y.copies[k].signal_dbm);
    }
    other += x.fate != z.fate ? 1 : 0;
  }
  EXPECT_GT(other, 0);
}

TEST(Link, InterferenceComesInSpellsOfTheNamedShare) {
  const LinkSpec spec{.burst_every_s = 9.0, .burst_s = 1.0, .burst_loss = 1.0};
  const Counts counts = CarryMany(spec, 10.0, false);
  EXPECT_NEAR(counts.interference, 2000, 400);  // 1 s in 10.
  // Neighbours share their fate.
  Link link(spec, 3, 1, 2);
  int lost = 0, lost_again = 0;
  bool was_lost = false;
  for (int i = 0; i < 20000; ++i) {
    const bool is_lost =
        link.Carry(kStart + i * 100000LL, 10.0, false).fate == Link::Fate::kInterference;
    lost += was_lost ? 1 : 0;
    lost_again += was_lost && is_lost ? 1 : 0;
    was_lost = is_lost;
  }
  EXPECT_GT(lost_again, lost * 3 / 4);
}

TEST(Link, SecondCopiesAndLateOnesAreAsManyAsNamed) {
  const Counts counts =
      CarryMany({.late_share = 0.1, .late_s = 0.15, .duplicate_share = 0.25}, 10.0, false);
  EXPECT_NEAR(counts.copies, 25000, 300);
  EXPECT_GT(counts.overtaken, 1000);
  EXPECT_EQ(CarryMany({}, 10.0, false).overtaken, 0);
}

TEST(Link, TheSignalFallsWithDistanceAndBehindObstacles) {
  const LinkSpec spec;
  const double near = CarryMany(spec, 10.0, false).signal_dbm;
  EXPECT_NEAR(near, spec.signal_10m_dbm, 0.5);
  EXPECT_NEAR(CarryMany(spec, 100.0, false).signal_dbm, near - 22.0, 0.5);
  EXPECT_NEAR(CarryMany(spec, 10.0, true).signal_dbm, near - 10.0, 0.5);
}

}  // namespace
}  // namespace v2vouch::sim
