// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/source_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace v2vouch {
namespace {

using Kind = NoticeSubject::Kind;
using Ruling = SourceClock::Ruling;

Timestamp At(double seconds) { return FromMicros(1'700'000'000'000'000) + FromSeconds(seconds); }

/// One source of a car: when it measures, how late its messages arrive, and what its clock shows.
struct Sender {
  NoticeSubject subject;
  double period_s = 0.05;
  double delay_s = 0.02;
  double phase_s = 0.0;
  std::function<double(double)> clock = [](double t) { return t; };
  double from_s = 0.0;  ///< Silent before.
  double to_s = 1e9;    ///< Silent from then on.
};

/// Six sources as a car has them: ego motion, three radars, two cameras, the second one slow.
std::vector<Sender> Car() {
  return {{.subject = {Kind::kEgoMotion, 0}, .period_s = 0.02, .delay_s = 0.005},
          {.subject = {Kind::kRadar, 0}, .phase_s = 0.003},
          {.subject = {Kind::kRadar, 1}, .phase_s = 0.019},
          {.subject = {Kind::kRadar, 2}, .phase_s = 0.036},
          {.subject = {Kind::kCamera, 0}, .period_s = 0.1, .delay_s = 0.08},
          {.subject = {Kind::kCamera, 1}, .period_s = 0.1, .delay_s = 0.3}};
}

struct Count {
  int accepted = 0;
  int refused = 0;
  std::map<Ruling, int> by;
  double first_accepted_s = 1e9;  ///< Arrival.
  double last_accepted_s = -1.0;
  double longest_gap_s = 0.0;  ///< Between two accepted messages, of arrival.
};

struct Heard {
  std::vector<Count> sources;
  std::vector<double> restarts_s;  ///< Arrival.
  double agreed_off_s = 0.0;       ///< Largest |agreed - true time| from 1 s on, delays included.
  std::vector<Notice> notices;     ///< At the end.
};

Heard Drive(const std::vector<Sender>& senders, double duration_s) {
  std::vector<std::tuple<double, std::size_t, double>> arrivals;  // When, who, measured at.
  for (std::size_t i = 0; i < senders.size(); ++i) {
    const Sender& sender = senders[i];
    for (double t = sender.phase_s; t < duration_s; t += sender.period_s) {
      if (t >= sender.from_s && t < sender.to_s) arrivals.emplace_back(t + sender.delay_s, i, t);
    }
  }
  std::ranges::sort(arrivals);
  SourceClock clock{TimelineConfig{}};
  Heard run;
  run.sources.resize(senders.size());
  for (const auto& [now_s, i, t] : arrivals) {
    const auto judged = clock.Judge(senders[i].subject, At(senders[i].clock(t)));
    Count& count = run.sources[i];
    ++count.by[judged.ruling];
    if (judged.is_restart) run.restarts_s.push_back(now_s);
    if (judged.ruling == Ruling::kAccept) {
      ++count.accepted;
      if (count.last_accepted_s >= 0.0) {
        count.longest_gap_s = std::max(count.longest_gap_s, now_s - count.last_accepted_s);
      }
      count.first_accepted_s = std::min(count.first_accepted_s, now_s);
      count.last_accepted_s = now_s;
    } else {
      ++count.refused;
    }
    if (now_s > 1.0) {
      run.agreed_off_s =
          std::max(run.agreed_off_s, std::abs(ToSeconds(*clock.agreed() - At(now_s))));
    }
  }
  clock.CollectNotices(run.notices);
  return run;
}

bool Tells(const Heard& run, NoticeKind kind, const NoticeSubject& subject) {
  return std::ranges::any_of(run.notices, [&](const Notice& notice) {
    return notice.kind == kind && notice.subject == subject;
  });
}

TEST(SourceClock, AGoodCarLosesNothing) {
  const Heard run = Drive(Car(), 20.0);
  for (const Count& count : run.sources) EXPECT_EQ(count.refused, 0);
  EXPECT_TRUE(run.restarts_s.empty());
  EXPECT_TRUE(run.notices.empty());
  EXPECT_LT(run.agreed_off_s, 0.3);
}

// Any one source, ego motion included, by any amount, from the first message on or later.
TEST(SourceClock, OneWrongClockCostsOnlyItsOwner) {
  for (std::size_t wrong = 0; wrong < Car().size(); ++wrong) {
    for (const double off_s : {-86400.0, -3600.0, -37.0, -1.0, 0.9, 1.5, 37.0, 3600.0, 3.2e7}) {
      for (const double from_s : {-1.0, 5.0}) {
        std::vector<Sender> car = Car();
        if (from_s < 0.0) car[wrong].delay_s = 0.0;  // First to be heard.
        if (from_s < 0.0) car[wrong].phase_s = 0.0;
        car[wrong].clock = [=](double t) { return t >= from_s ? t + off_s : t; };
        const Heard run = Drive(car, 10.0);
        const std::string what =
            std::to_string(wrong) + " " + std::to_string(off_s) + " " + std::to_string(from_s);
        for (std::size_t i = 0; i < car.size(); ++i) {
          if (i == wrong) continue;
          EXPECT_LE(run.sources[i].longest_gap_s, 2.5 * car[i].period_s) << what << " " << i;
          EXPECT_LE(run.sources[i].first_accepted_s, 0.5) << what << " " << i;
          EXPECT_LE(run.sources[i].refused, 3) << what << " " << i;
        }
        // Within the buffer's reach it takes half a second to see that nobody supports it.
        EXPECT_LE(run.sources[wrong].last_accepted_s,
                  std::max(0.0, from_s) + car[wrong].delay_s + 0.5 + 2.0 * car[wrong].period_s)
            << what;
        EXPECT_LE(run.restarts_s.size(), from_s < 0.0 ? 1u : 0u) << what;
        EXPECT_TRUE(Tells(run, off_s > 0 ? NoticeKind::kClockAhead : NoticeKind::kClockBehind,
                          car[wrong].subject))
            << what;
        EXPECT_LT(run.agreed_off_s, 0.45) << what;
      }
    }
  }
}

// Two of six, by the same or different amounts.
TEST(SourceClock, TwoWrongClocksOfSixAreSurvived) {
  const double offs[][2] = {{0.9, 0.9}, {37, 37}, {-2, -2}, {3600, -3600}, {0.9, -86400}, {1, 2}};
  for (std::size_t a = 0; a < 6; ++a) {
    for (std::size_t b = a + 1; b < 6; ++b) {
      for (const auto& off_s : offs) {
        std::vector<Sender> car = Car();
        car[a].clock = [=](double t) { return t + off_s[0]; };
        car[b].clock = [=](double t) { return t + off_s[1]; };
        const Heard run = Drive(car, 10.0);
        for (std::size_t i = 0; i < car.size(); ++i) {
          if (i == a || i == b) continue;
          EXPECT_LE(run.sources[i].longest_gap_s, 2.5 * car[i].period_s)
              << a << " " << b << " " << off_s[0] << " " << off_s[1] << " " << i;
          EXPECT_LE(run.sources[i].first_accepted_s, 0.5);
        }
      }
    }
  }
}

TEST(SourceClock, ADriftingClockIsRefusedOnceItIsOutAndTakenBackWhenRight) {
  for (const double drift : {0.05, -0.05}) {
    for (std::size_t wrong = 1; wrong < 6; ++wrong) {
      std::vector<Sender> car = Car();
      // Drifts for 40 s, is set right at 40 s.
      car[wrong].clock = [=](double t) { return t < 40.0 ? t + drift * t : t; };
      const Heard run = Drive(car, 45.0);
      for (std::size_t i = 0; i < car.size(); ++i) {
        if (i != wrong) {
          EXPECT_LE(run.sources[i].refused, 0) << wrong << " " << i;
        }
      }
      EXPECT_TRUE(run.restarts_s.empty());
      EXPECT_GT(run.sources[wrong].refused, 100);
      EXPECT_GT(run.sources[wrong].last_accepted_s, 44.0) << wrong;
      EXPECT_TRUE(run.notices.empty()) << wrong;
    }
  }
}

// 0.6 s is within the buffer, but nobody else has come so far.
TEST(SourceClock, AFrameThatNobodySupportsIsRefused) {
  std::vector<Sender> car = Car();
  car[1].clock = [](double t) { return t + 0.6; };
  const Heard run = Drive(car, 5.0);
  EXPECT_LE(run.sources[1].accepted, 12);
  EXPECT_TRUE(Tells(run, NoticeKind::kClockAhead, car[1].subject));
  EXPECT_EQ(run.sources[0].refused, 0);
}

// Nothing works without ego motion: it is taken as far as the buffer goes, and named.
TEST(SourceClock, EgoMotionWithinTheBufferIsTakenAndTold) {
  for (const double off_s : {-0.6, -0.5, 0.4, 0.6}) {
    std::vector<Sender> car = Car();
    car[0].clock = [=](double t) { return t + off_s; };
    const Heard run = Drive(car, 5.0);
    for (const Count& count : run.sources) EXPECT_EQ(count.refused, 0) << off_s;
    EXPECT_TRUE(Tells(run, off_s > 0.0 ? NoticeKind::kClockAhead : NoticeKind::kClockBehind,
                      car[0].subject))
        << off_s;
    EXPECT_EQ(run.notices.size(), 1u) << off_s;
  }
}

TEST(SourceClock, AStuckClockIsRefusedAndTold) {
  for (std::size_t wrong = 0; wrong < 6; ++wrong) {
    std::vector<Sender> car = Car();
    car[wrong].clock = [](double t) { return std::min(t, 3.0); };
    const Heard run = Drive(car, 6.0);
    EXPECT_TRUE(Tells(run, NoticeKind::kClockStuck, car[wrong].subject)) << wrong;
    for (std::size_t i = 0; i < 6; ++i) {
      if (i != wrong) {
        EXPECT_EQ(run.sources[i].refused, 0) << wrong << " " << i;
      }
    }
  }
}

TEST(SourceClock, AllStuckTakeAFewMessagesAndNoMore) {
  std::vector<Sender> car = Car();
  for (Sender& sender : car) sender.clock = [](double t) { return std::min(t, 3.0); };
  const Heard at_3 = Drive(car, 3.4);
  const Heard at_60 = Drive(car, 60.0);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(at_60.sources[i].accepted, at_3.sources[i].accepted) << i;
  }
}

// Boot clock, GNSS sets the time: everybody steps within a moment, either way, by any amount.
TEST(SourceClock, AStepOfTheCommonClockIsOneRestartWithinHalfASecond) {
  for (const double step_s : {-3.2e7, -86400.0, -3600.0, -5.0, -1.0, -0.5, -0.3, 3.5, 3600.0,
                              86400.0, 3.2e7, 1.7e9 - 10.0}) {
    std::vector<Sender> car = Car();
    for (Sender& sender : car) {
      sender.clock = [=](double t) { return t < 5.0 ? t : t + step_s; };
    }
    const Heard run = Drive(car, 10.0);
    ASSERT_EQ(run.restarts_s.size(), 1u) << step_s;
    EXPECT_GE(run.restarts_s[0], 5.0) << step_s;
    EXPECT_LE(run.restarts_s[0], 5.5) << step_s;
    for (std::size_t i = 0; i < car.size(); ++i) {
      EXPECT_LE(run.sources[i].longest_gap_s, 0.5) << step_s << " " << i;
      EXPECT_GT(run.sources[i].last_accepted_s, 9.8) << step_s << " " << i;
    }
  }
}

TEST(SourceClock, AGapOfAllIsNoStep) {
  for (const double gap_s : {0.3, 1.0, 2.5}) {
    std::vector<Sender> car = Car();
    for (Sender& sender : car) {
      sender.clock = [=](double t) { return t < 5.0 ? t : t + gap_s; };  // By order alone: a gap.
    }
    const Heard run = Drive(car, 10.0);
    EXPECT_TRUE(run.restarts_s.empty()) << gap_s;
    for (const Count& count : run.sources) EXPECT_LE(count.refused, 6) << gap_s;
  }
}

// Whoever falls silent must not hold back the others, however many they are.
TEST(SourceClock, ManyThatFallSilentHoldNobodyBack) {
  for (unsigned mask = 1; mask < 63; ++mask) {
    if (std::popcount(mask) > 4) continue;  // One alone cannot be told from one that is wrong.
    std::vector<Sender> car = Car();
    for (int i = 0; i < 6; ++i) {
      if ((mask >> i & 1) != 0) car[static_cast<std::size_t>(i)].to_s = 5.0;
    }
    const Heard run = Drive(car, 10.0);
    EXPECT_TRUE(run.restarts_s.empty()) << mask;
    for (int i = 0; i < 6; ++i) {
      if ((mask >> i & 1) != 0) continue;
      EXPECT_EQ(run.sources[static_cast<std::size_t>(i)].refused, 0) << mask << " " << i;
    }
  }
}

// Twenty-five old scans at once, as after a hung bridge; then the source goes on as it should.
TEST(SourceClock, ABacklogCostsTheMessagesOfItsOwner) {
  for (std::size_t wrong = 1; wrong < 6; ++wrong) {
    SourceClock clock{TimelineConfig{}};
    std::vector<Sender> car = Car();
    int refused = 0;
    int restarts = 0;
    double burst_s = 7.0;
    std::vector<double> held;
    for (double now_s = 0.0; now_s < 10.0; now_s += 0.01) {
      for (std::size_t i = 0; i < car.size(); ++i) {
        const auto steps = std::lround(now_s / 0.01);
        if (steps % std::lround(car[i].period_s / 0.01) != 0) continue;
        if (i == wrong && now_s > 7.0 - 25.0 * car[i].period_s && now_s < burst_s) {
          held.push_back(now_s);
          continue;
        }
        if (i == wrong) {
          for (const double old_s : held) {
            const auto judged = clock.Judge(car[i].subject, At(old_s));
            restarts += judged.is_restart ? 1 : 0;
          }
          held.clear();
        }
        const auto judged = clock.Judge(car[i].subject, At(now_s));
        restarts += judged.is_restart ? 1 : 0;
        if (i != wrong && judged.ruling != Ruling::kAccept) ++refused;
        if (i == wrong && now_s > 8.0) {
          EXPECT_EQ(judged.ruling, Ruling::kAccept) << wrong;
        }
      }
    }
    EXPECT_EQ(refused, 0) << wrong;
    EXPECT_EQ(restarts, 0) << wrong;
  }
}

// Sensors behind one gateway (three radars of one bus, a perception computer's boxes and pictures)
// are held up together. While their backlog arrives nobody else speaks.
TEST(SourceClock, ABacklogOfSeveralSourcesAtOnceIsNoStepBack) {
  const std::vector<Sender> car = Car();
  const std::vector<std::vector<std::size_t>> gateways = {{1, 2},    {1, 4}, {4, 5},
                                                          {1, 2, 3}, {2, 5}, {0, 4}};
  for (const auto& held_up : gateways) {
    for (const double held_s : {0.5, 1.25, 3.0, 10.0}) {
      for (const bool is_in_turn : {false, true}) {  // One source after the other, or by time.
        std::vector<std::tuple<double, double, std::size_t, double>> arrivals;
        for (std::size_t i = 0; i < car.size(); ++i) {
          const bool is_held_up = std::ranges::find(held_up, i) != held_up.end();
          for (double t = car[i].phase_s; t < 30.0; t += car[i].period_s) {
            const bool is_old = is_held_up && t > 15.0 - held_s && t < 15.0;
            const double order = is_old && is_in_turn ? static_cast<double>(i) : t;
            arrivals.emplace_back(is_old ? 15.0 : t, order, i, t);
          }
        }
        std::ranges::sort(arrivals);
        SourceClock clock{TimelineConfig{}};
        int restarts = 0;
        int others_refused = 0;
        int refused_later = 0;
        for (const auto& [now_s, order, i, t] : arrivals) {
          const auto judged = clock.Judge(car[i].subject, At(t));
          restarts += judged.is_restart ? 1 : 0;
          const bool is_refused = judged.ruling != Ruling::kAccept;
          const bool is_held_up = std::ranges::find(held_up, i) != held_up.end();
          if (is_refused && !is_held_up) ++others_refused;
          if (is_refused && is_held_up && now_s > 16.0) ++refused_later;
        }
        const std::string which = std::to_string(held_up.front()) + " and others, " +
                                  std::to_string(held_s) + " s" + (is_in_turn ? ", in turn" : "");
        EXPECT_EQ(restarts, 0) << which;
        EXPECT_EQ(others_refused, 0) << which;
        EXPECT_EQ(refused_later, 0) << which;
      }
    }
  }
}

TEST(SourceClock, PicturesThroughAJitteringNetworkAreNoStepBack) {
  std::vector<Sender> car = Car();
  // Reordered arrivals: the delay swings by 0.25 s from picture to picture.
  for (std::size_t i = 4; i < 6; ++i) {
    car[i].clock = [](double t) { return std::lround(t * 10.0) % 2 == 0 ? t : t - 0.25; };
  }
  const Heard run = Drive(car, 30.0);
  EXPECT_TRUE(run.restarts_s.empty());
  for (const Count& count : run.sources) EXPECT_EQ(count.refused, 0);
}

TEST(SourceClock, MoreMessagesThanAnySensorSendsAreRefused) {
  std::vector<Sender> car = Car();
  car[2].period_s = 1.0 / 3000.0;
  const Heard run = Drive(car, 5.0);
  EXPECT_LE(run.sources[2].accepted, 5 * 110);
  EXPECT_GT(run.sources[2].by.at(Ruling::kOverRate), 14000);
  for (std::size_t i = 0; i < 6; ++i) {
    if (i != 2) {
      EXPECT_EQ(run.sources[i].refused, 0) << i;
    }
  }
}

TEST(SourceClock, GuestsAreJudgedAndNotAsked) {
  SourceClock clock{TimelineConfig{}};
  const NoticeSubject gnss{Kind::kGnss, 0};
  EXPECT_EQ(clock.JudgeGuest(gnss, At(1e6)), Ruling::kAccept);  // Nobody else has spoken.
  EXPECT_FALSE(clock.agreed());
  clock.Judge({Kind::kRadar, 0}, At(0.0));
  EXPECT_EQ(clock.JudgeGuest(gnss, At(0.9)), Ruling::kAccept);
  // GNSS time runs 18 s ahead of UTC: the receiver that tells it is named.
  for (int i = 0; i < 5; ++i) EXPECT_EQ(clock.JudgeGuest(gnss, At(18.0)), Ruling::kAhead);
  EXPECT_EQ(clock.agreed(), At(0.0));
  std::vector<Notice> notices;
  clock.CollectNotices(notices);
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].kind, NoticeKind::kClockAhead);
  EXPECT_EQ(notices[0].subject, gnss);
  EXPECT_NEAR(notices[0].value, 18.0, 1e-6);
}

}  // namespace
}  // namespace v2vouch
