// SPDX-License-Identifier: Apache-2.0
// What a flood leaves in memory: bounded tables that the next flood uses again, and nothing more.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "daemon/pipeline/perception.h"
#include "tests/support/flood.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::FloodKind;

// Bytes that have been asked for and not been given back.
double HeldMb() {
  const auto held = mallinfo2();
  return static_cast<double>(held.uordblks + held.hblkhd) * 1e-6;
}

double SecondOf(const Input& input) { return ToSeconds(HeaderOf(input).stamp - DriveStart()); }

TEST(Memory, ASecondFloodTakesNoMoreThanTheFirst) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "SKIPPED: the sanitizer's allocator does not count";
#endif
  testing::SyntheticDrive drive;
  drive.duration_s = 12.0;
  for (int i = 0; i < 10; ++i) {
    drive.cars.push_back({.x_m = 14.0 + 13.0 * (i / 5),
                          .y_m = 3.5 * (i % 5 - 2),
                          .speed_mps = 8.0 + 0.1 * i,
                          .sender = i % 3 == 0 ? static_cast<SenderId>(100 + i) : 0});
  }
  // 500 cars within 60 m that do not exist: as many claims are of interest as can be.
  std::vector<Input> flood = testing::FloodOf(FloodKind::kSybils, 5000.0, 3.0, drive);
  std::erase_if(flood, [](const Input& input) {
    const double at_s = SecondOf(input);
    return at_s > 5.0 && at_s < 9.0;
  });
  const std::vector<Input> inputs = testing::Merged(testing::MakeInputs(drive), flood);
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  double before_mb = 0.0;
  double first_mb = 0.0;
  double second_mb = 0.0;
  for (const Input& input : inputs) {
    perception.Step(input, outputs);
    const double at_s = SecondOf(input);
    if (at_s < 3.0) before_mb = HeldMb();
    if (at_s >= 3.0 && at_s < 9.0) first_mb = std::max(first_mb, HeldMb());
    if (at_s >= 9.0) second_mb = std::max(second_mb, HeldMb());
  }
  EXPECT_GT(first_mb, before_mb + 2.0) << "the flood is none";
  // 0.2 MB; 3.8 MB where each claim's place in the buffer came to hold a frame's vectors.
  EXPECT_LT(second_mb, first_mb + 1.0);
}

// What the process holds of the system, used or not.
double TakenMb() {
  const auto held = mallinfo2();
  return static_cast<double>(held.arena + held.hblkhd) * 1e-6;
}

TEST(Memory, ClocksThatStepAgainAndAgainTakeNoMoreThanOnce) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "SKIPPED: the sanitizer's allocator does not count";
#endif
  testing::SyntheticDrive drive;
  drive.duration_s = 2.0;
  drive.cars.push_back({.x_m = 25.0, .y_m = 0.0, .speed_mps = 8.5, .sender = 0x11});
  Perception perception(PerceptionConfig{}, std::make_unique<NullBiasEstimator>());
  Outputs outputs;
  double first_mb = 0.0;
  for (int lap = 0; lap < 6; ++lap) {
    int restarts = 0;
    for (Input input : testing::MakeInputs(drive)) {
      std::visit([&](auto& message) { message.stamp += FromSeconds(20.0 * lap); }, input);
      perception.Step(input, outputs);
      restarts += static_cast<int>(
          std::ranges::count(outputs.diagnostics, Reason::kClockRestart, &Diagnostic::reason));
    }
    EXPECT_EQ(restarts, lap > 0 ? 1 : 0);
    if (lap == 0) first_mb = TakenMb();
  }
  // 23 MB more where the new tables of senders are made beside the old ones.
  EXPECT_LT(TakenMb(), first_mb + 3.0);
}

}  // namespace
}  // namespace v2vouch
