// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "daemon/common/base/random.h"
#include "daemon/v2v/association/pair_table.h"

namespace v2vouch {
namespace {

// A claim with 1 m of white noise beside a track known to 0.2 m.
PairObservation Observation(double time_s, const Eigen::Vector2d& residual_m,
                            double speed_residual_mps = 0.0) {
  PairObservation observation;
  observation.stamp = FromMicros(0) + FromSeconds(time_s);
  observation.residual_m = residual_m;
  observation.sensed = 0.04 * Eigen::Matrix2d::Identity();
  observation.speed_residual_mps = speed_residual_mps;
  return observation;
}

Eigen::Vector2d White(Random& random) { return {random.Normal(), random.Normal()}; }

TEST(PairEvidence, LearnsAnHonestBiasAndStaysConsistent) {
  const AssociationConfig config;
  Random random(3);
  int consistent = 0;
  for (int run = 0; run < 200; ++run) {
    const Eigen::Vector2d bias = 1.5 * White(random);
    PairEvidence evidence(config, std::nullopt, Observation(0.0, bias + White(random)));
    for (int i = 1; i < 60; ++i) {
      evidence.Add(Observation(0.1 * i, bias + White(random), 0.2 * random.Normal()), config);
    }
    consistent += evidence.is_nis_consistent() ? 1 : 0;
    EXPECT_GT(evidence.score(), 0.0);
    EXPECT_LT((evidence.bias() - bias).norm(), 0.9);  // 1 m / sqrt(60) = 0.13 m per axis, 5 sigma.
  }
  EXPECT_GE(consistent, 193);  // 99 % band, and 99 % of latest messages.
}

// After a long agreement the track goes over to a neighbour: the first message says so.
TEST(PairEvidence, IsNotConsistentAtAMessageThatDoesNotFit) {
  const AssociationConfig config;
  PairEvidence evidence(config, std::nullopt, Observation(0.0, {0.5, 0.0}));
  for (int i = 1; i < 20; ++i) evidence.Add(Observation(1.0 * i, {0.5, 0.0}), config);
  EXPECT_TRUE(evidence.is_nis_consistent());
  evidence.Add(Observation(20.0, {0.5, 4.5}), config);
  EXPECT_FALSE(evidence.is_nis_consistent());
  evidence.Add(Observation(21.0, {0.5, 0.0}), config);
  EXPECT_TRUE(evidence.is_nis_consistent());
}

TEST(PairEvidence, DifferentSpeedEndsTheLikeness) {
  const AssociationConfig config;
  PairEvidence evidence(config, std::nullopt, Observation(0.0, {0.5, 0.0}));
  for (int i = 1; i < 30; ++i) {
    evidence.Add(Observation(0.1 * i, {0.5 + 0.3 * i, 0.0}, 3.0), config);
  }
  EXPECT_LT(evidence.score(), 0.0);
}

// A hidden sender and a car without radio that passes in the next lane, 2 m/s faster: level and NIS
// take the moving offset for a bias.
TEST(PairEvidence, WhoPassesInTheNextLaneIsNotTheSender) {
  const AssociationConfig config;
  Random random(13);
  int plausible = 0;
  int honest = 0;
  for (int run = 0; run < 200; ++run) {
    const auto passing = [&](int i) {
      const Eigen::Vector2d offset(1.5 - 0.2 * i, 2.8);
      return Observation(0.1 * i, offset + White(random), -2.0 + 0.2 * random.Normal());
    };
    const auto own = [&](int i) {
      return Observation(0.1 * i, White(random), 0.3 + 0.2 * random.Normal());
    };
    PairEvidence other(config, std::nullopt, passing(0));
    PairEvidence same(config, std::nullopt, own(0));
    for (int i = 1; i < 16; ++i) {
      other.Add(passing(i), config);
      same.Add(own(i), config);
    }
    const bool looks_alike = other.is_nis_consistent() && other.level() <= config.max_level;
    plausible += looks_alike && other.is_speed_consistent(config) ? 1 : 0;
    honest += same.is_speed_consistent(config) ? 1 : 0;
  }
  EXPECT_EQ(plausible, 0);
  EXPECT_EQ(honest, 200);
}

// A queue: the sender stands 5.2 m behind the only car that has a track. Message by message it
// agrees as well as an honest bias would; the level tells.
TEST(PairEvidence, ANeighbourThatStandsIsNoBiasHoweverLongItAgrees) {
  const AssociationConfig config;
  Random random(11);
  int plausible = 0;
  for (int run = 0; run < 200; ++run) {
    const Eigen::Vector2d offset(0.8, 5.2);
    PairEvidence evidence(config, std::nullopt, Observation(0.0, offset));
    for (int i = 1; i < 300; ++i) {
      evidence.Add(Observation(0.1 * i, offset + White(random), 0.2 * random.Normal()), config);
    }
    EXPECT_GT(evidence.score(), 10.0);
    plausible += evidence.level() <= config.max_level ? 1 : 0;
  }
  EXPECT_EQ(plausible, 0);
}

TEST(PairEvidence, HonestBiasIsPlausible) {
  const AssociationConfig config;
  Random random(12);
  int plausible = 0;
  for (int run = 0; run < 200; ++run) {
    // 1.05 m per axis: two receivers of 0.74 m each.
    const Eigen::Vector2d bias = 1.05 * White(random);
    PairEvidence evidence(config, std::nullopt, Observation(0.0, bias + White(random)));
    for (int i = 1; i < 60; ++i) {
      evidence.Add(Observation(0.1 * i, bias + White(random)), config);
    }
    plausible += evidence.level() <= config.max_level ? 1 : 0;
  }
  EXPECT_GE(plausible, 196);  // (3.67 / 1.05)^2 / 2 = 6.1: 0.2 % lie beyond.
}

TEST(PairEvidence, AStaleFastSenderIsPlausibleAlongItsTrackOnly) {
  const AssociationConfig config;
  const auto level = [&](const Eigen::Vector2d& residual_m) {
    const auto at = [&](double time_s) {
      PairObservation observation = Observation(time_s, residual_m);
      observation.stale(0, 0) = 1.8 * 1.8;  // 0.075 s at 24 m/s.
      return observation;
    };
    PairEvidence evidence(config, std::nullopt, at(0.0));
    for (int i = 1; i < 60; ++i) evidence.Add(at(0.1 * i), config);
    return evidence.level();
  };
  EXPECT_LE(level({5.0, 0.0}), config.max_level);
  EXPECT_GT(level({0.0, 5.0}), config.max_level);
}

TEST(PairTable, FarClaimStartsNoPair) {
  const AssociationConfig config;
  PairTable table;
  EXPECT_EQ(table.Observe(1, 10, Observation(0.0, {12.0, 0.0}), std::nullopt, config), nullptr);
  EXPECT_TRUE(table.pairs().empty());
}

TEST(PairTable, EachSenderHasOneTrackAndEachTrackOneSender) {
  const AssociationConfig config;
  PairTable table;
  // Two cars 4 m apart, two senders, each 0.5 m off its own car.
  for (int i = 0; i < 20; ++i) {
    table.Observe(1, 10, Observation(0.1 * i, {0.5, 0.0}), std::nullopt, config);
    table.Observe(1, 11, Observation(0.1 * i, {-3.5, 0.0}), std::nullopt, config);
    table.Observe(2, 10, Observation(0.1 * i, {4.5, 0.0}), std::nullopt, config);
    table.Observe(2, 11, Observation(0.1 * i, {0.5, 0.0}), std::nullopt, config);
  }
  table.Assign(config);
  ASSERT_NE(table.AssignedTo(1), nullptr);
  ASSERT_NE(table.AssignedTo(2), nullptr);
  EXPECT_EQ(table.AssignedTo(1)->track_id, 10u);
  EXPECT_EQ(table.AssignedTo(2)->track_id, 11u);
}

TEST(PairTable, SybilsOnOneCarLeaveNobodyAMargin) {
  const AssociationConfig config;
  PairTable table;
  Random random(5);
  for (int i = 0; i < 30; ++i) {
    for (const SenderId sender : {1u, 2u, 3u}) {
      table.Observe(sender, 10, Observation(0.1 * i, {0.3 * sender, 0.0}), std::nullopt, config);
    }
  }
  table.Assign(config);
  int assigned = 0;
  for (const auto& pair : table.pairs()) {
    assigned += pair.is_assigned ? 1 : 0;
    EXPECT_LT(table.Margin(pair), config.min_margin);
  }
  EXPECT_EQ(assigned, 1);
}

TEST(PairTable, IncumbentKeepsItsTrackAgainstASlightlyBetterRival) {
  const AssociationConfig config;
  PairTable table;
  for (int i = 0; i < 30; ++i) {
    table.Observe(1, 10, Observation(0.1 * i, {1.0, 0.0}), std::nullopt, config);
    table.Observe(2, 10, Observation(0.1 * i, {0.0, 0.0}), std::nullopt, config);
  }
  table.Assign(config);
  EXPECT_NE(table.AssignedTo(2), nullptr);
  table.SetIncumbent(1, 10);
  table.Assign(config);
  EXPECT_NE(table.AssignedTo(1), nullptr);
  EXPECT_EQ(table.AssignedTo(2), nullptr);
}

TEST(PairTable, NeighbourThatBelongsToAnotherIsNoRival) {
  const AssociationConfig config;
  PairTable table;
  for (int i = 0; i < 3; ++i) {
    table.Observe(1, 10, Observation(0.1 * i, {0.0, 0.0}), std::nullopt, config);
    table.Observe(1, 11, Observation(0.1 * i, {1.5, 0.0}), std::nullopt, config);
    table.Observe(2, 11, Observation(0.1 * i, {0.0, 0.0}), std::nullopt, config);
  }
  EXPECT_LT(table.Margin(*table.Find(1, 10)), config.min_margin);
  table.SetIncumbent(2, 11);
  EXPECT_EQ(table.Margin(*table.Find(1, 10)), std::numeric_limits<double>::infinity());
}

TEST(PairTable, StaysWithinItsBoundWhoeverSends) {
  AssociationConfig config;
  config.max_pairs = 16;
  PairTable table;
  table.Observe(1, 10, Observation(0.0, {0.0, 0.0}), std::nullopt, config);
  table.SetIncumbent(1, 10);
  for (SenderId sender = 100; sender < 1100; ++sender) {
    table.Observe(sender, 10, Observation(0.1, {0.1, 0.0}), std::nullopt, config);
  }
  EXPECT_LE(table.pairs().size(), 16u);
  EXPECT_NE(table.Find(1, 10), nullptr);
}

}  // namespace
}  // namespace v2vouch
