// SPDX-License-Identifier: Apache-2.0
// What the message stream alone finds of each lie, told by senders that are otherwise honest.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "daemon/common/base/random.h"
#include "tests/daemon/v2v/intake/honest_sender.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

constexpr double kMetre_rad = 1.0 / 6.37e6;  // Of latitude.

// Changes a message of its sender; `first` is the message in which the lie began.
using Lie = std::function<void(Bsm& bsm, const Bsm& first, int n, Random& random)>;

struct Case {
  const char* name;
  Lie lie;
  Check check;              // The one that must find it ...
  double least_share;       // ... in this share of the messages from 2 s on while it drives,
  double most_median_s;     // with the first one after this at the median.
  bool is_accused = false;  // Whether it must come to an accusation.
};

std::ostream& operator<<(std::ostream& os, const Case& c) { return os << c.name; }

class Lies : public ::testing::TestWithParam<Case> {};

// The lie begins at 20 s, in vehicles that drive by then.
TEST_P(Lies, AreFound) {
  const Case& c = GetParam();
  int told = 0;
  int found = 0;
  int accused = 0;
  int vehicles = 0;
  int named = 0;
  std::vector<double> first_s;
  for (std::uint64_t seed = 101; seed <= 130; ++seed) {
    std::vector<Bsm> messages = HonestMessages({.gap_s = 0.0}, 40.0, seed);
    const auto from = std::ranges::find_if(messages, [](const Bsm& bsm) {
      return ToMicros(bsm.stamp) > kNoon_us + 20'000'000 && *bsm.speed_mps > 8.0 &&
             bsm.transmission == Transmission::kForward;
    });
    if (messages.end() - from < 60) continue;
    ++vehicles;
    const Bsm first = *from;
    Random random(seed);
    int n = 0;
    BsmIntake intake{IntakeConfig{.max_senders = 16, .repeat_memory_s = 1.0}};
    double after_s = 100.0;
    bool is_accused = false;
    bool is_named = false;
    for (Bsm& bsm : messages) {
      const double since_s = ToSeconds(bsm.stamp - first.stamp);
      const bool is_driving = *bsm.speed_mps > 5.0;
      if (since_s >= 0.0) c.lie(bsm, first, n++, random);
      const auto claim = intake.Accept(bsm, EgoAtCrossroads());
      const bool is_found = !claim || claim->finding;
      if (since_s < 0.0) continue;
      if (claim && claim->finding) {
        is_accused = is_accused || claim->finding->severity == Verdict::kAccuse;
        is_named = is_named || c.check == claim->finding->check;
        after_s = std::min(after_s, since_s);
      }
      if (since_s < 2.0 || !is_driving) continue;
      ++told;
      found += is_found ? 1 : 0;
    }
    first_s.push_back(after_s);
    named += is_named ? 1 : 0;
    accused += is_accused ? 1 : 0;
  }
  std::ranges::sort(first_s);
  const double share = static_cast<double>(found) / told;
  const double median_s = first_s[first_s.size() / 2];
  std::cout << std::left << std::setw(24) << c.name << std::right << std::setprecision(3)
            << 100.0 * share << " % of " << told << ", median " << median_s << " s, p90 "
            << first_s[first_s.size() * 9 / 10] << ", accused " << accused << " of " << vehicles
            << "\n";
  EXPECT_GE(share, c.least_share);
  EXPECT_LE(median_s, c.most_median_s);
  EXPECT_GT(named, vehicles / 2);
  EXPECT_GE(accused, c.is_accused ? vehicles / 2 : 0);
}

Lie Speed(double offset_mps) {
  return [=](Bsm& bsm, const Bsm&, int, Random&) { *bsm.speed_mps += offset_mps; };
}
Lie Turned(double by_deg) {
  return [=](Bsm& bsm, const Bsm&, int, Random&) {
    bsm.course_rad = WrapAngle(*bsm.course_rad + FromDegrees(by_deg));
  };
}

INSTANTIATE_TEST_SUITE_P(
    Catalogue, Lies,
    ::testing::Values(
        Case{"speed + 2 m/s", Speed(2.0), Check::kSpeedAgainstPath, 0.7, 4.0},
        Case{"speed + 4 m/s", Speed(4.0), Check::kSpeedAgainstPath, 0.9, 2.0},
        Case{"speed + 7 m/s", Speed(7.0), Check::kSpeedAgainstPath, 0.95, 1.5},
        Case{"speed - 3 m/s", Speed(-3.0), Check::kSpeedAgainstPath, 0.9, 3.0},
        Case{"zero speed", [](Bsm& bsm, const Bsm&, int, Random&) { bsm.speed_mps = 0.0; },
             Check::kSpeedAgainstPath, 0.95, 1.5, true},
        Case{"40 m/s", [](Bsm& bsm, const Bsm&, int, Random&) { bsm.speed_mps = 40.0; },
             Check::kSpeedAgainstPath, 0.95, 1.5, true},
        Case{"random speed",
             [](Bsm& bsm, const Bsm&, int, Random& random) {
               const double offset =
                   random.Uniform(1.0, 7.0) * (random.Bernoulli(0.5) ? 1.0 : -1.0);
               *bsm.speed_mps = std::abs(*bsm.speed_mps + offset);
             },
             Check::kOwnMotion, 0.9, 2.0},
        Case{"reversed heading", Turned(180.0), Check::kCourseAgainstPath, 0.95, 1.5, true},
        Case{"heading + 90", Turned(90.0), Check::kCourseAgainstPath, 0.95, 1.5, true},
        Case{"heading + 30", Turned(30.0), Check::kCourseAgainstPath, 0.8, 3.0},
        Case{"heading + 18 per message",
             [](Bsm& bsm, const Bsm&, int n, Random&) {
               bsm.course_rad = WrapAngle(*bsm.course_rad + FromDegrees(18.0) * n);
             },
             Check::kSpeedAgainstPath, 0.9, 2.0},
        Case{"frozen place",
             [](Bsm& bsm, const Bsm& first, int, Random&) {
               bsm.latitude_rad = first.latitude_rad;
               bsm.longitude_rad = first.longitude_rad;
             },
             Check::kSpeedAgainstPath, 0.95, 1.7, true},
        Case{"sudden stop",
             [](Bsm& bsm, const Bsm& first, int, Random&) {
               bsm.latitude_rad = first.latitude_rad;
               bsm.longitude_rad = first.longitude_rad;
               bsm.speed_mps = 0.0;
             },
             Check::kImplausibleMotion, 0.0, 0.3},
        Case{"random offset 20 to 70 m",
             [](Bsm& bsm, const Bsm&, int, Random& random) {
               const double side = random.Bernoulli(0.5) ? 1.0 : -1.0;
               *bsm.latitude_rad += side * random.Uniform(20.0, 70.0) * kMetre_rad;
             },
             Check::kPositionJump, 0.4, 0.3, true},
        Case{"one teleport of 30 m",
             [](Bsm& bsm, const Bsm&, int, Random&) { *bsm.latitude_rad += 30.0 * kMetre_rad; },
             Check::kPositionJump, 0.0, 0.1},
        Case{"one second late",
             [](Bsm& bsm, const Bsm&, int, Random&) {
               bsm.sec_mark_ms = (*bsm.sec_mark_ms + 59000) % 60000;
             },
             Check::kLateMessages, 0.95, 1.2},
        Case{"size per message",
             [](Bsm& bsm, const Bsm&, int n, Random&) { bsm.length_m = n % 2 == 0 ? 4.6 : 5.2; },
             Check::kSizeChange, 0.95, 0.3}),
    [](const auto& test) { return "Case" + std::to_string(test.index); });

}  // namespace
}  // namespace v2vouch
