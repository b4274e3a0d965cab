// SPDX-License-Identifier: Apache-2.0
// Every file of the catalogue: what its messages come to on the campaign street, held against what
// the file promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "tests/sim/attacks/radio_run.h"

namespace v2vouch::sim {
namespace {

constexpr double kAny = std::numeric_limits<double>::infinity();

struct Band {
  double low = -kAny;
  double high = kAny;
};

// How false the false messages of a run are: the largest difference from the honest statement, but
// for the first, which is the median; NaN where there is no vehicle.
struct Falseness {
  int count = 0;          // Messages marked as attack.
  int attackers = 0;      // Transmitters that attack.
  double first_s = kAny;  // Of them.
  double median_m = 0.0, largest_m = 0.0;
  double speed_mps = 0.0, heading_deg = 0.0, accel_mps2 = 0.0, length_ratio = 1.0;
  double age_s = 0.0;
  double identities = 0.0;  // Most of one transmitter.
  double per_s = 0.0;       // Highest rate of one transmitter in a second.
  bool has_phantoms = false;
};

Falseness Measure(const std::vector<Received>& received, double start_s) {
  Falseness f;
  std::set<std::int64_t> attackers;
  std::vector<double> offsets;
  std::map<std::int64_t, std::set<std::array<std::uint8_t, 4>>> identities;
  std::map<std::pair<std::int64_t, std::int64_t>, int> rates;
  for (const auto& [bsm, truth, message] : received) {
    if (truth.is_attack == 0) continue;
    ++f.count;
    attackers.insert(truth.device_id);
    f.first_s = std::min(f.first_s, message.time_s);
    f.age_s = std::max(f.age_s, truth.age_s);
    identities[truth.device_id].insert(message.identity.id);
    const auto second = static_cast<std::int64_t>(message.time_s);
    f.per_s = std::max(f.per_s, static_cast<double>(++rates[{truth.device_id, second}]));
    f.has_phantoms = f.has_phantoms || truth.vehicle_id == 0;
    if (truth.vehicle_id == 0) continue;
    offsets.push_back(
        std::hypot(truth.claimed_x_m - truth.honest_x_m, truth.claimed_y_m - truth.honest_y_m));
    const double heading = AngleDifference(truth.claimed_yaw_rad, truth.honest_yaw_rad);
    f.heading_deg = std::max(f.heading_deg, std::abs(ToDegrees(heading)));
    f.speed_mps = std::max(f.speed_mps, std::abs(truth.claimed_speed_mps - truth.honest_speed_mps));
    f.accel_mps2 =
        std::max(f.accel_mps2, std::abs(truth.claimed_accel_mps2 - truth.honest_accel_mps2));
    f.length_ratio = std::max({f.length_ratio, truth.claimed_length_m / truth.honest_length_m,
                               truth.honest_length_m / truth.claimed_length_m});
  }
  f.attackers = static_cast<int>(attackers.size());
  for (const auto& [device, ids] : identities) {
    f.identities = std::max(f.identities, static_cast<double>(ids.size()));
  }
  if (!offsets.empty()) {
    std::sort(offsets.begin(), offsets.end());
    f.median_m = offsets[offsets.size() / 2];
    f.largest_m = offsets.back();
  }
  EXPECT_GE(f.first_s, start_s);
  return f;
}

// What a file's messages must come to. A field left out must stay within what rounding makes of an
// honest message, so that no attack does more than it says.
struct Promise {
  const char* file;
  Band largest_m{0.0, 0.02};
  Band speed_mps{0.0, 0.011};
  Band heading_deg{0.0, 0.01};
  Band age_s{0.0, 0.21};
  Band identities{1.0, 1.0};
  bool phantoms = false;
  Band per_s{0.0, 12.0};
  Band accel_mps2{0.0, 0.006};
  Band length_ratio{1.0, 1.01};
};

bool IsIn(double value, const Band& band) { return value >= band.low && value <= band.high; }

// Drift and walk-off: rate times the time left, and the speed that goes with it. At most the 36 s
// after the earliest start.
Promise Lateral(const char* file, double rate) {
  Promise p{file};
  p.largest_m = {rate * 5.0, rate * 36.0 + 0.05};
  p.speed_mps = {0.0, rate + 0.02};
  p.heading_deg = {0.5 * rate, 91.0};  // A standing car drifts sideways: 90 degrees.
  return p;
}

Promise Along(const char* file, double rate) {
  Promise p{file};
  p.largest_m = {rate * 5.0, rate * 36.0 + 0.05};
  p.speed_mps = {rate - 0.02, rate + 0.02};
  return p;
}

Promise Offset(const char* file, double low, double high) {
  Promise p{file};
  p.largest_m = {low, high};
  return p;
}

Promise Ghost(const char* file, double identities = 1.0) {
  Promise p{file};
  p.phantoms = true;
  p.identities = {identities, identities};
  p.per_s = {9.0, 12.0 * identities};
  return p;
}

// A shadow: late by 0.3 s of at most 7 m/s, noise 0.7 m (five sigma), besides the receiver's error.
Promise Shadow(const char* file, double low_m, double high_m, double speed_mps,
               double heading_deg) {
  Promise p{file};
  p.largest_m = {low_m, high_m};
  p.speed_mps = {0.0, speed_mps};
  p.heading_deg = {0.0, heading_deg};
  p.age_s = {0.37, 0.51};
  p.accel_mps2 = {0.0, 5.0};
  return p;
}

const Promise kPromises[] = {
    Ghost("A01_ahead_15m"),
    Ghost("A01_ahead_30m"),
    Ghost("A01_ahead_60m"),
    Ghost("A02_sudden_stop"),
    Ghost("A03_braking_in"),
    Ghost("A04_from_occlusion"),
    Offset("A05_offset_20_70m", 28.2, 99.1),
    Offset("A05_lateral_3m", 2.98, 3.02),
    Offset("A05_lateral_5m", 4.98, 5.02),
    Offset("A05_lateral_8m", 7.98, 8.02),
    Offset("A05_lateral_12m", 11.98, 12.02),
    Offset("A05_veremi_250_150", 291.5, 291.6),
    Offset("A06_random_20_70m", 80.0, 99.1),  // The largest of hundreds of draws.
    Offset("A06_random_35m", 40.0, 49.6),
    Offset("A06_random_300m", 350.0, 424.4),
    Lateral("A07_lateral_0.1mps", 0.1),
    Lateral("A07_lateral_0.2mps", 0.2),
    Lateral("A07_lateral_0.3mps", 0.3),
    Lateral("A07_lateral_0.5mps", 0.5),
    Lateral("A07_lateral_1mps", 1.0),
    Lateral("A07_lateral_2mps", 2.0),
    Along("A07_along_0.1mps", 0.1),
    Along("A07_along_0.2mps", 0.2),
    Along("A07_along_0.3mps", 0.3),
    Along("A07_along_0.5mps", 0.5),
    Along("A07_along_1mps", 1.0),
    Along("A07_along_2mps", 2.0),
    Offset("A08_jump_5m", 4.98, 5.02),
    Offset("A08_jump_10m", 9.98, 10.02),
    Offset("A08_jump_30m", 29.98, 30.02),
    Offset("A08_jump_100m", 99.98, 100.02),
    {.file = "A09_own_6s",
     .largest_m = {1.0, 45.0},
     .speed_mps = {0.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {6.0, 6.4},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A09_victim",
     .largest_m = {5.0, 420.0},
     .speed_mps = {0.5, 12.0},
     .heading_deg = {0.0, 180.0},
     .age_s = {0.9, 1.9},
     .accel_mps2 = {0.0, 3.0},
     .length_ratio = {1.0, 6.0}},
    {.file = "A09_victim_fresh",
     .largest_m = {5.0, 420.0},
     .speed_mps = {0.5, 12.0},
     .heading_deg = {0.0, 180.0},
     .age_s = {0.9, 1.9},
     .accel_mps2 = {0.0, 3.0},
     .length_ratio = {1.0, 6.0}},
    {.file = "A09_minute",
     .largest_m = {0.1, 600.0},
     .speed_mps = {0.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {60.0, 60.3},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A10_delay_0.5s",
     .largest_m = {1.0, 5.0},
     .speed_mps = {0.0, 2.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {0.57, 0.81},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A10_delay_1s",
     .largest_m = {3.0, 9.0},
     .speed_mps = {0.0, 4.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {1.07, 1.31},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A10_delay_2_4s",
     .largest_m = {5.0, 30.0},
     .speed_mps = {0.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {2.07, 4.31},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A10_delay_2_4s_restamped",
     .largest_m = {5.0, 30.0},
     .speed_mps = {0.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {2.07, 4.31},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A10_stale_60",
     .largest_m = {1.0, 45.0},
     .speed_mps = {0.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .age_s = {5.9, 6.3},
     .accel_mps2 = {0.0, 3.0}},
    Ghost("A11_grid_5", 5.0),
    Ghost("A11_grid_20", 20.0),
    Ghost("A11_grid_5_round_vehicle", 5.0),
    Ghost("A11_grid_20_round_vehicle", 20.0),
    {.file = "A12_three_ids",
     .largest_m = {0.1, 4.5},
     .speed_mps = {0.0, 0.011},
     .identities = {3.0, 3.0},
     .per_s = {27.0, 36.0}},
    Shadow("A13_10s_0.5mps", 4.0, 20.0, 1.0, 91.0),
    Shadow("A13_10s_1mps", 8.0, 36.0, 1.5, 91.0),
    Shadow("A13_10s_2mps", 16.0, 66.0, 2.5, 91.0),
    Shadow("A13_10s_5mps", 40.0, 156.0, 5.5, 91.0),
    Shadow("A13_20s_2mps", 5.0, 42.0, 2.5, 91.0),
    Shadow("A13_10s_brake", 15.0, 250.0, 8.0, 5.0),
    Shadow("A14_1mps", 4.0, 40.0, 1.5, 91.0),
    Shadow("A14_2mps", 8.0, 70.0, 2.5, 91.0),
    Shadow("A14_5mps", 20.0, 160.0, 5.5, 91.0),
    Shadow("A14_brake", 15.0, 250.0, 8.0, 5.0),
    {.file = "A15_swap",
     .largest_m = {2.0, 300.0},
     .speed_mps = {0.5, 10.0},
     .heading_deg = {0.0, 181.0},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A16_frozen_true_speed", .largest_m = {50.0, 200.0}},
    {.file = "A16_frozen_zero_speed", .largest_m = {50.0, 200.0}, .speed_mps = {4.0, 8.0}},
    {.file = "A16_eventual_stop",
     .largest_m = {50.0, 200.0},
     .speed_mps = {4.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A16_sudden_stop",
     .largest_m = {50.0, 200.0},
     .speed_mps = {4.0, 8.0},
     .heading_deg = {0.0, 5.0},
     .accel_mps2 = {0.0, 3.0}},
    {.file = "A17_add_1_7mps", .speed_mps = {1.0, 7.02}},
    {.file = "A17_add_2_7mps", .speed_mps = {2.0, 7.02}},
    {.file = "A17_random_1_7mps", .speed_mps = {6.5, 7.02}},
    {.file = "A17_random_40mps", .speed_mps = {28.0, 40.1}},
    {.file = "A17_zero", .speed_mps = {4.0, 8.0}},
    {.file = "A17_frozen", .speed_mps = {0.02, 8.0}},
    {.file = "A17_40mps", .speed_mps = {32.0, 40.1}},
    {.file = "A18_180deg", .heading_deg = {179.9, 180.0}},
    {.file = "A18_90deg", .heading_deg = {89.9, 90.1}},
    {.file = "A18_30deg", .heading_deg = {29.9, 30.1}},
    {.file = "A18_rotating", .heading_deg = {170.0, 180.0}},
    {.file = "A19_feigned_braking", .accel_mps2 = {0.0, 10.0}},
    {.file = "A19_stronger", .accel_mps2 = {0.0, 10.0}},
    {.file = "A19_hard_brake", .accel_mps2 = {4.5, 8.0}},
    {.file = "A20_every_10_messages", .identities = {20.0, 27.0}},
    {.file = "A20_every_1s", .identities = {20.0, 27.0}},
    {.file = "A20_every_message", .identities = {200.0, 260.0}},
    {.file = "A20_whitewash_offset", .largest_m = {7.98, 8.02}, .identities = {5.0, 6.0}},
    {.file = "A20_whitewash_drift",
     .largest_m = {5.0, 36.1},
     .speed_mps = {0.0, 1.02},
     .heading_deg = {0.5, 91.0},
     .identities = {3.0, 6.0}},
    Offset("A21_offset_12.7m", 7.98, 8.02),
    Lateral("A21_drift_12.7m", 0.5),
    Offset("A21_offset_unavailable", 7.98, 8.02),
    Lateral("A21_drift_unavailable", 0.5),
    // Copies are reckoned on over less than 0.1 s, which rounding apart is what would be true.
    {.file = "A22_4x", .largest_m = {0.0, 0.05}, .per_s = {36.0, 44.0}},
    {.file = "A22_40x", .largest_m = {0.0, 0.05}, .per_s = {370.0, 440.0}},
    {.file = "A22_1000x", .largest_m = {0.0, 0.05}, .per_s = {9000.0, 11000.0}},
    {.file = "A23_impersonate", .largest_m = {9.0, 13.0}, .speed_mps = {0.0, 0.011}},
    {.file = "A24_mirror", .largest_m = {3.4, 11.0}},
    {.file = "A25_x3", .length_ratio = {2.99, 3.01}},
    {.file = "A25_swapped", .length_ratio = {2.0, 6.0}},
    {.file = "A25_random", .length_ratio = {2.5, 3.4}},
    {.file = "A26_drift",
     .largest_m = {1.8, 2.05},
     .speed_mps = {0.0, 1.02},
     .heading_deg = {0.5, 91.0}},
    Offset("A26_jump", 9.98, 10.02),
    {.file = "A27_senders",
     .largest_m = {9.98, 10.03},
     .speed_mps = {0.0, 1.02},
     .heading_deg = {0.0, 180.0}},
    {.file = "A27_both",
     .largest_m = {9.98, 10.03},
     .speed_mps = {0.0, 1.02},
     .heading_deg = {0.0, 180.0}},
    Offset("A28_2m", 1.98, 2.02),
    Offset("A28_4m", 3.98, 4.02),
};

// No false messages of units: floods come raw, A27_ego is about the ego's receiver.
const std::set<std::string> kWithoutFalseMessages = {"A22_random_5000", "A22_malformed_5000",
                                                     "A27_ego"};

class Catalogue : public testing::TestWithParam<Promise> {};

std::string Told(const Falseness& f) {
  return "largest " + std::to_string(f.largest_m) + " m, " + std::to_string(f.speed_mps) +
         " m/s, " + std::to_string(f.heading_deg) + " deg, " + std::to_string(f.accel_mps2) +
         " m/s2, length x " + std::to_string(f.length_ratio) + ", age " + std::to_string(f.age_s) +
         " s, " + std::to_string(f.identities) + " ids, " + std::to_string(f.per_s) + " per s";
}

TEST_P(Catalogue, MessagesAreAsFalseAsTheFileSays) {
  const Promise& promise = GetParam();
  const Scenario scenario = CampaignScenario("campaign_urban", promise.file);
  ASSERT_FALSE(scenario.attacks.empty());
  std::vector<std::string> notes;
  const auto received = RadioRun(scenario, 11, &notes);
  EXPECT_TRUE(notes.empty()) << notes.front();
  const Falseness f = Measure(received, scenario.attacks[0].when.start_s);
  EXPECT_GT(f.count, 30);
  EXPECT_GE(f.attackers, 1);
  EXPECT_TRUE(IsIn(f.largest_m, promise.largest_m)) << Told(f);
  EXPECT_TRUE(IsIn(f.speed_mps, promise.speed_mps)) << Told(f);
  EXPECT_TRUE(IsIn(f.heading_deg, promise.heading_deg)) << Told(f);
  EXPECT_TRUE(IsIn(f.accel_mps2, promise.accel_mps2)) << Told(f);
  EXPECT_TRUE(IsIn(f.length_ratio, promise.length_ratio)) << Told(f);
  EXPECT_TRUE(IsIn(f.age_s, promise.age_s)) << Told(f);
  EXPECT_TRUE(IsIn(f.identities, promise.identities)) << Told(f);
  EXPECT_TRUE(IsIn(f.per_s, promise.per_s)) << Told(f);
  EXPECT_EQ(f.has_phantoms, promise.phantoms);
}

INSTANTIATE_TEST_SUITE_P(All, Catalogue, testing::ValuesIn(kPromises), [](const auto& one) {
  std::string name = one.param.file;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(CatalogueFolder, EveryFileLoadsAndEveryAttackHasItsPromise) {
  std::set<std::string> promised = kWithoutFalseMessages;
  for (const Promise& promise : kPromises) promised.insert(promise.file);
  std::set<std::string> ids;
  for (const auto& entry : std::filesystem::directory_iterator("sim/attacks/catalogue")) {
    const std::string stem = entry.path().stem().string();
    ids.insert(stem.substr(0, 3));
    if (stem[0] == 'A') {
      EXPECT_EQ(promised.count(stem), 1u) << stem;
    }
    EXPECT_LE(stem.size(), 32u);
  }
  EXPECT_EQ(ids.size(), 28u + 15u);
}

}  // namespace
}  // namespace v2vouch::sim
