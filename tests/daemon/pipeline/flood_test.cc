// SPDX-License-Identifier: Apache-2.0
// A flooded radio changes nothing for those who were there before, and little for newcomers.
#include "tests/support/flood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "daemon/pipeline/perception.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::FloodKind;
using testing::FloodOf;
using testing::MakeInputs;
using testing::Merged;
using testing::SyntheticDrive;

constexpr SenderId kEstablished = 0x11;
constexpr SenderId kNewcomer = 0x22;
constexpr double kFlood_s = 4.0;
constexpr double kNewcomerSpeaks_s = 5.0;

// Two cars ahead in lanes of their own; one of them begins to speak amid the flood.
SyntheticDrive TwoCars() {
  SyntheticDrive drive;
  drive.duration_s = 9.0;
  drive.cars.push_back({.x_m = 25.0, .y_m = 0.0, .speed_mps = 8.5, .sender = kEstablished});
  drive.cars.push_back({.x_m = 45.0, .y_m = 7.0, .speed_mps = 8.2, .sender = kNewcomer});
  return drive;
}

struct Ride {
  std::map<SenderId, double> entered_s;  // When a sender first had a PRIORITY vehicle.
  std::map<SenderId, int> lists;         // In how many lists after the flood began.
  int lists_in_flood = 0;
  int without_local = 0;  // PRIORITY lines that rest on no LOCAL track.
  std::size_t most = 0;
  std::vector<double> local;  // All of LOCAL's states.
  int accused = 0;
};

Ride Drive(const std::vector<Input>& inputs) {
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  Ride ride;
  for (const Input& input : inputs) {
    if (const auto* bsm = std::get_if<Bsm>(&input)) {
      const bool is_early = ToSeconds(bsm->stamp - DriveStart()) < kNewcomerSpeaks_s;
      if (bsm->sender == kNewcomer && is_early) continue;
    }
    perception.Step(input, outputs);
    for (const MisbehaviorReport& report : outputs.reports) {
      const bool is_honest = report.sender == kEstablished || report.sender == kNewcomer;
      ride.accused += is_honest && report.verdict == Verdict::kAccuse ? 1 : 0;
    }
    if (!outputs.has_lists) continue;
    const double t = ToSeconds(outputs.priority.stamp - DriveStart());
    ride.lists_in_flood += t > kFlood_s ? 1 : 0;
    ride.most = std::max(ride.most, outputs.priority.tracks.size());
    for (const PublishedTrack& line : outputs.priority.tracks) {
      ride.entered_s.try_emplace(line.sender, t);
      ride.lists[line.sender] += t > kFlood_s ? 1 : 0;
      ride.without_local += line.local_id == 0 ? 1 : 0;
    }
    for (const PublishedTrack& line : outputs.local.tracks) {
      for (const double value : line.track.state_O.mean) ride.local.push_back(value);
    }
  }
  return ride;
}

struct Case {
  FloodKind kind;
  double rate_hz;
  double most_delay_s;  // Of the newcomer's entry.
};

class FloodedPerception : public ::testing::TestWithParam<Case> {};

TEST_P(FloodedPerception, KeepsWhomItKnowsAndLetsNewcomersIn) {
  const SyntheticDrive drive = TwoCars();
  const std::vector<Input> inputs = MakeInputs(drive);
  const Ride calm = Drive(inputs);
  ASSERT_LT(calm.entered_s.at(kEstablished), kFlood_s);
  ASSERT_EQ(calm.lists.at(kEstablished), calm.lists_in_flood);
  ASSERT_GT(calm.entered_s.at(kNewcomer), kNewcomerSpeaks_s);

  const Ride flooded =
      Drive(Merged(inputs, FloodOf(GetParam().kind, GetParam().rate_hz, kFlood_s, drive)));
  EXPECT_TRUE(flooded.local == calm.local);  // Bit for bit.
  EXPECT_EQ(flooded.lists_in_flood, calm.lists_in_flood);
  EXPECT_EQ(flooded.lists.at(kEstablished), calm.lists.at(kEstablished));
  EXPECT_LE(flooded.most, drive.cars.size());
  EXPECT_EQ(flooded.without_local, 0);
  EXPECT_EQ(flooded.accused, 0);
  ASSERT_TRUE(flooded.entered_s.contains(kNewcomer));
  EXPECT_LE(flooded.entered_s.at(kNewcomer),
            calm.entered_s.at(kNewcomer) + GetParam().most_delay_s);
  for (const auto& [sender, when_s] : flooded.entered_s) {
    EXPECT_TRUE(sender == kEstablished || sender == kNewcomer) << sender << " at " << when_s;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, FloodedPerception,
    ::testing::Values(Case{FloodKind::kRefused, 5000.0, 0.0}, Case{FloodKind::kRandom, 5000.0, 0.5},
                      Case{FloodKind::kOneId, 40.0, 0.2}, Case{FloodKind::kOneId, 400.0, 0.2},
                      Case{FloodKind::kOneId, 10000.0, 0.2}, Case{FloodKind::kCrowd, 5000.0, 1.0}),
    [](const auto& test) { return "Kind" + std::to_string(test.index); });

// 200 identities round the established car, each moving as it does: whoever is relied on stays so,
// and there are never more PRIORITY vehicles than there are cars.
TEST(FloodedPerceptionBySybils, NeverOutnumberTheCarsNorDriveOutTheValidated) {
  const SyntheticDrive drive = TwoCars();
  const std::vector<Input> inputs = MakeInputs(drive);
  const Ride calm = Drive(inputs);
  const Ride flooded = Drive(Merged(inputs, FloodOf(FloodKind::kSybils, 2000.0, kFlood_s, drive)));
  EXPECT_TRUE(flooded.local == calm.local);
  EXPECT_EQ(flooded.lists.at(kEstablished), calm.lists.at(kEstablished));
  EXPECT_LE(flooded.most, drive.cars.size());
  EXPECT_EQ(flooded.without_local, 0);
  EXPECT_EQ(flooded.accused, 0);
}

// A frame's own step must not take the time that a thousand lines cost.
TEST(Flood, AListOfManySendersIsMadeInPiecesAfterTheFrames) {
  const SyntheticDrive drive = TwoCars();
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  std::size_t most_with_a_frame = 0;
  std::size_t most = 0;
  int lists = 0;
  Timestamp last{};
  for (const Input& input :
       Merged(MakeInputs(drive), FloodOf(FloodKind::kCrowd, 10000.0, kFlood_s, drive))) {
    perception.Step(input, outputs);
    if (!outputs.has_v2v_list) continue;
    ++lists;
    EXPECT_GT(outputs.v2v.stamp, last);
    last = outputs.v2v.stamp;
    const auto& lines = outputs.v2v.tracks;
    EXPECT_TRUE(std::ranges::is_sorted(lines, std::ranges::less_equal{},
                                       [](const auto& line) { return line.track.id; }) ||
                lines.size() < 2);
    most = std::max(most, lines.size());
    if (outputs.has_lists) most_with_a_frame = std::max(most_with_a_frame, lines.size());
  }
  EXPECT_GT(most, 900u);
  EXPECT_GT(lists, 80);
  EXPECT_LE(most_with_a_frame, 32u);
}

}  // namespace
}  // namespace v2vouch
