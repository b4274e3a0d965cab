// SPDX-License-Identifier: Apache-2.0
#include "sim/baseline/baseline_tracker.h"

#include <gtest/gtest.h>

#include <cmath>

namespace v2vouch::baseline {
namespace {

/// An ego at 10 m/s with one radar and one camera at its rear axle, and cars seen by them.
class Drive : public testing::Test {
 protected:
  Drive() {
    vehicle_.radars.resize(1);
    vehicle_.radars[0].x_m = vehicle_.radars[0].y_m = vehicle_.radars[0].yaw_rad = 0.0;
    vehicle_.cameras[0].x_m = 0.0;
    tracker_ = BaselineTracker(vehicle_);
  }

  void Step(double rear_m, double closing_mps, bool has_box) {
    utime_ += 50'000;
    ego_motion_t motion{};
    motion.utime = utime_;
    motion.speed_mps = 10.0;
    tracker_.TakeMotion(motion);
    radar_scan_t scan{};
    scan.utime = utime_;
    // Its rear face, and a weak return 2 m deeper.
    for (const auto& [range, snr] : {std::pair(rear_m, 40.0), {rear_m + 2.0, 18.0}}) {
      radar_detection_t d{};
      d.range_m = range;
      d.range_rate_mps = -closing_mps;
      d.snr_db = snr;
      d.track_id = -1;
      scan.detections.push_back(d);
    }
    scan.num_detections = 2;
    tracker_.TakeRadar(vehicle_.radars[0], scan);
    if (!has_box) return;
    camera_detections_t picture{};
    picture.utime = utime_;
    camera_box_t box{};
    box.left_px = 600.0;
    box.width_px = 80.0;
    box.top_px = 340.0;
    box.height_px = 60.0;
    box.class_name = "car";
    box.score = 0.9;
    picture.boxes.push_back(box);
    picture.num_boxes = 1;
    tracker_.TakeCamera(vehicle_.cameras[0], picture);
  }

  VehicleConfig vehicle_;
  BaselineTracker tracker_{vehicle_};
  std::int64_t utime_ = 1'000'000;
};

TEST_F(Drive, AMovingCarIsListedByRadarAloneHalfALengthBehindItsNearFace) {
  for (int k = 0; k < 40; ++k) Step(30.0 - 0.1 * k, 2.0, false);
  const track_list_t list = tracker_.List();
  ASSERT_EQ(list.num_tracks, 1);
  EXPECT_NEAR(list.tracks[0].x_body_m, 30.0 - 3.9 + 2.25, 0.3);
  EXPECT_NEAR(list.tracks[0].y_body_m, 0.0, 0.2);
  EXPECT_NEAR(list.tracks[0].speed_mps, 8.0, 0.3);
}

TEST_F(Drive, AStandingCarIsListedWhenACameraSeesIt) {
  for (int k = 0; k < 10; ++k) Step(40.0 - 0.5 * k, 10.0, false);
  EXPECT_EQ(tracker_.List().num_tracks, 0);
  Step(35.0, 10.0, true);
  ASSERT_EQ(tracker_.List().num_tracks, 1);
  EXPECT_EQ(tracker_.List().tracks[0].object_class, track_t::CLASS_CAR);
}

TEST_F(Drive, ATrackWithoutHitsGoes) {
  for (int k = 0; k < 20; ++k) Step(30.0, 0.0, false);
  ASSERT_EQ(tracker_.List().num_tracks, 1);
  radar_scan_t empty{};
  empty.utime = utime_ + 700'000;
  tracker_.TakeRadar(vehicle_.radars[0], empty);
  EXPECT_EQ(tracker_.List().num_tracks, 0);
}

}  // namespace
}  // namespace v2vouch::baseline
