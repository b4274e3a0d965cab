// SPDX-License-Identifier: Apache-2.0
// What the checks of the message stream alone hold against honest senders: never an accusation,
// and a share of the messages that stays small. Prints the shares.
#include <gtest/gtest.h>

#include <iomanip>
#include <iostream>
#include <map>
#include <string>

#include "tests/daemon/v2v/intake/honest_sender.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace v2vouch {
namespace {

struct Tally {
  int claims = 0;
  int withdrawn = 0;
  int accused = 0;
  std::map<std::string, int> by_check;
  [[nodiscard]] double share() const { return claims == 0 ? 0.0 : 1.0 * withdrawn / claims; }
};

void Add(const std::vector<Bsm>& messages, Tally& tally) {
  BsmIntake intake{IntakeConfig{.max_senders = 16, .repeat_memory_s = 1.0}};
  for (const Bsm& bsm : messages) {
    const auto claim = intake.Accept(bsm, EgoAtCrossroads());
    if (!claim) continue;
    ++tally.claims;
    if (!claim->finding) continue;
    ++(claim->finding->severity == Verdict::kAccuse ? tally.accused : tally.withdrawn);
    ++tally.by_check[std::string(NameOf(claim->finding->check))];
  }
}

struct Condition {
  const char* name;
  HonestErrors errors;
  double most_withdrawn;
};

std::ostream& operator<<(std::ostream& os, const Condition& condition) {
  return os << condition.name;
}

class HonestFindings : public ::testing::TestWithParam<Condition> {};

// One vehicle-hour of each condition: 30 vehicles for two minutes.
TEST_P(HonestFindings, AreFewAndNeverAccuse) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Add(HonestMessages(GetParam().errors, 120.0, seed), tally);
  }
  std::cout << std::left << std::setw(22) << GetParam().name << std::right << tally.claims
            << " claims, " << std::setprecision(3) << 100.0 * tally.share() << " % withdrawn, "
            << tally.accused << " accused;";
  for (const auto& [check, count] : tally.by_check) std::cout << " " << check << " " << count;
  std::cout << "\n";
  EXPECT_EQ(tally.accused, 0);
  EXPECT_LE(tally.share(), GetParam().most_withdrawn);
  EXPECT_GT(tally.claims, 1000);
}

INSTANTIATE_TEST_SUITE_P(
    Conditions, HonestFindings,
    ::testing::Values(
        Condition{"plain", {}, 0.002}, Condition{"bias 3 m", {.bias_sigma_m = 3.0}, 0.002},
        Condition{"white 1 m", {.white_m = 1.0}, 0.002},
        Condition{"bursts of 8 m", {.burst_m = 8.0}, 0.10},
        Condition{"... reported", {.burst_m = 8.0, .is_burst_reported = true}, 0.002},
        Condition{"... 5 m within 0.5 s",
                  {.burst_m = 5.0, .burst_rise_s = 0.5, .is_burst_reported = true},
                  0.002},
        Condition{"loss 54 %", {.latency_spread_s = 0.27, .stale_s = 0.15, .loss = 0.54}, 0.002},
        Condition{"loss 77 %, gaps",
                  {.latency_spread_s = 0.27, .stale_s = 0.15, .loss = 0.77, .gap_s = 7.0},
                  0.002},
        Condition{"stale 0.3 s", {.latency_spread_s = 0.27, .stale_s = 0.3}, 0.01},
        Condition{"1 Hz", {.rate_hz = 1.0, .loss = 0.0}, 0.002},
        Condition{"pairs", {.loss = 0.0, .pair_share = 0.1}, 0.002},
        Condition{"steps of 3 m", {.step_m = 3.0}, 0.01},
        Condition{
            "parked, 12.7 m",
            {.bias_sigma_m = 5.0, .bias_time_s = 20.0, .accuracy_m = 12.65, .is_moving = false},
            0.002}),
    [](const auto& test) { return "Condition" + std::to_string(test.index); });

}  // namespace
}  // namespace v2vouch
