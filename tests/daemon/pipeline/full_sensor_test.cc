// SPDX-License-Identifier: Apache-2.0
// Sensors that fill every message: what LOCAL makes of them, and how much it keeps to do so. The
// times stand in tests/benchmark/full_sensor_benchmark.cc.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "daemon/local/perception/local_perception.h"
#include "tests/support/full_radar.h"

namespace v2vouch {
namespace {

using testing::FullKind;

testing::SyntheticDrive TenCars() {
  testing::SyntheticDrive drive;
  drive.duration_s = 4.0;
  for (int i = 0; i < 10; ++i) {
    drive.cars.push_back({.x_m = 14.0 + 13.0 * (i / 5),
                          .y_m = 3.5 * (i % 5 - 2),
                          .speed_mps = 8.0 + 0.3 * (i % 5 - 2)});
  }
  return drive;
}

struct Most {
  std::size_t tracks = 0;  // After any frame, listed or not.
  std::size_t listed = 0;
};

Most MostOf(const std::vector<Input>& inputs) {
  LocalPerception local{LocalConfig{}};
  LocalFrame frame;
  Most most;
  for (const Input& input : inputs) {
    RadarPreparation prepared;
    if (const auto* motion = std::get_if<EgoMotion>(&input)) {
      local.OnEgoMotion(*motion);
    } else if (const auto* scan = std::get_if<RadarScan>(&input)) {
      local.OnRadarScan(*scan, prepared, frame);
    } else if (const auto* boxes = std::get_if<CameraDetections>(&input)) {
      local.OnCameraDetections(*boxes, frame);
    }
    most.tracks = std::max(most.tracks, frame.tracks.size());
    const auto listed = std::ranges::count_if(frame.tracks, &LocalTrack::is_confirmed);
    most.listed = std::max(most.listed, static_cast<std::size_t>(listed));
  }
  return most;
}

// Every track costs a prediction, its gate, its place in a checkpoint: 128 that are not listed, and
// those that are.
constexpr std::size_t kMostTracks = 128 + 24;
// Ten cars, and what a few hundred false returns in each scan look like by chance.
constexpr std::size_t kMostListed = 24;

class FullRadar : public ::testing::TestWithParam<FullKind> {};

TEST_P(FullRadar, IsNotPublishedAsVehiclesAndCostsABoundedTable) {
  const Most most = MostOf(WithFullRadars(TenCars(), GetParam()));
  EXPECT_LE(most.listed, kMostListed);
  EXPECT_LE(most.tracks, kMostTracks);
}

TEST_P(FullRadar, ThatBeginsAmongKnownCarsIsNotEither) {
  const Most most = MostOf(WithFullRadars(TenCars(), GetParam(), 2.0));
  EXPECT_GE(most.listed, 8u);  // Before it begins.
  EXPECT_LE(most.listed, kMostListed);
  EXPECT_LE(most.tracks, kMostTracks);
}

std::string NameOf(std::size_t index) {
  constexpr std::array<const char*, 3> kNames = {"Moving", "Ring", "Standing"};
  return kNames.at(index);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FullRadar,
                         ::testing::Values(FullKind::kMoving, FullKind::kRing, FullKind::kStanding),
                         [](const auto& kind) { return NameOf(kind.index); });

TEST(FullCamera, IsNotPublishedAsVehiclesAndCostsABoundedTable) {
  const Most most = MostOf(WithFullCameras(TenCars()));
  EXPECT_LE(most.listed, 12u);
  EXPECT_LE(most.tracks, kMostTracks);
}

}  // namespace
}  // namespace v2vouch
