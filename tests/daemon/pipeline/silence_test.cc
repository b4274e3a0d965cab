// SPDX-License-Identifier: Apache-2.0
// A sensor that falls silent: flagged within three of its periods, and the others carry on.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "daemon/pipeline/perception.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch {
namespace {

using testing::DriveStart;
using testing::MakeInputs;
using testing::SyntheticCar;
using testing::SyntheticDrive;

constexpr double kSilentFrom_s = 3.0;

struct Silence {
  double flagged_after_s = -1.0;  ///< From the silent sensor's last frame; < 0: never.
  double first_after_s = -1.0;    ///< From its last frame to the next list of any sensor.
  std::size_t tracks_at_end = 0;
  std::size_t degraded_or_blind = 0;  ///< Sectors of the last list.
  bool others_are_alive = true;
};

/// Feeds a drive from which sensor `silent` (radars first, then cameras) is missing from
/// kSilentFrom_s on; -1: none is.
Silence Feed(const SyntheticDrive& drive, int silent) {
  const int radars = static_cast<int>(drive.vehicle.radars.size());
  const int sensors = radars + static_cast<int>(drive.vehicle.cameras.size());
  const auto sensor_of = [&](const Input& input) {
    if (const auto* scan = std::get_if<RadarScan>(&input)) return scan->radar;
    if (const auto* boxes = std::get_if<CameraDetections>(&input)) return radars + boxes->camera;
    return -1;
  };
  PerceptionConfig config;
  config.vehicle = drive.vehicle;
  Perception perception(config, std::make_unique<NullBiasEstimator>());
  const auto is_alive = [&](int sensor) {
    return perception.IsAlive(sensor < radars ? SensorKey{SensorKind::kRadar, sensor}
                                              : SensorKey{SensorKind::kCamera, sensor - radars});
  };
  Silence result;
  Outputs outputs;
  Timestamp last{};
  for (const Input& input : MakeInputs(drive)) {
    const double t_s = ToSeconds(HeaderOf(input).stamp - DriveStart());
    const int sensor = sensor_of(input);
    if (silent >= 0 && sensor == silent) {
      if (t_s >= kSilentFrom_s) continue;
      last = HeaderOf(input).stamp;
    }
    perception.Step(input, outputs);
    if (!outputs.has_lists) continue;
    result.tracks_at_end = outputs.local.tracks.size();
    result.degraded_or_blind = static_cast<std::size_t>(std::ranges::count_if(
        outputs.local.sectors,
        [](const SectorHealth& sector) { return sector.state != SectorState::kWatched; }));
    if (t_s < kSilentFrom_s || silent < 0) continue;
    const double since_s = ToSeconds(outputs.local.stamp - last);
    if (result.first_after_s < 0.0) result.first_after_s = since_s;
    if (!is_alive(silent) && result.flagged_after_s < 0.0) result.flagged_after_s = since_s;
    for (int other = 0; other < sensors; ++other) {
      if (other != silent && !is_alive(other)) result.others_are_alive = false;
    }
  }
  return result;
}

SyntheticDrive Traffic() {
  SyntheticDrive drive;
  drive.duration_s = 5.0;
  drive.cars = {SyntheticCar{.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0},
                SyntheticCar{.x_m = 50.0, .y_m = -3.5, .speed_mps = 8.5}};
  return drive;
}

TEST(SilentSensor, IsFlaggedWithinThreePeriodsAndTheOthersCarryOn) {
  const SyntheticDrive drive = Traffic();
  const Silence whole = Feed(drive, -1);
  ASSERT_EQ(whole.tracks_at_end, 2u);
  const std::size_t radars = drive.vehicle.radars.size();
  for (std::size_t silent = 0; silent < radars + drive.vehicle.cameras.size(); ++silent) {
    const double period_s = silent < radars ? drive.vehicle.radars[silent].period_s
                                            : drive.vehicle.cameras[silent - radars].period_s;
    const Silence run = Feed(drive, static_cast<int>(silent));
    // The first list after three periods says so; lists come every 17 ms at most.
    EXPECT_GT(run.flagged_after_s, 3.0 * period_s) << silent;
    EXPECT_LE(run.flagged_after_s, 3.0 * period_s + 0.05) << silent;
    // Each radar alone covers some of what another covers too; nothing covers for the camera.
    if (silent >= radars) {
      EXPECT_GT(run.degraded_or_blind, whole.degraded_or_blind) << silent;
    }
    EXPECT_TRUE(run.others_are_alive) << silent;
    EXPECT_EQ(run.tracks_at_end, 2u) << silent;
    EXPECT_LE(run.first_after_s, 0.1) << silent;
  }
}

}  // namespace
}  // namespace v2vouch
