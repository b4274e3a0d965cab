// SPDX-License-Identifier: Apache-2.0
#include "sim/ladder/labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::ladder {
namespace {

using testing::ElementsAre;

/// An ego at 10 m/s in x with a radar and a camera at its axle; cars 20 m ahead: 1 at 8 m/s, 2
/// standing 4 m to its left, 3 hidden 20 m behind the first.
class Labels : public testing::Test {
 protected:
  Labels() {
    radar_.x_m = radar_.y_m = radar_.yaw_rad = 0.0;
    camera_.x_m = 0.0;
    const auto add = [&](std::int64_t id, double x, double y, double speed, bool is_hidden) {
      evaluation::TruthObject object;
      object.id = id;
      object.object_class = 1;
      object.length_m = 4.5;
      object.width_m = 1.8;
      for (int k = 0; k < 3; ++k) {
        evaluation::TruthSample sample;
        sample.stamp = FromMicros(50'000 * k);
        sample.motion = {x + 0.05 * k * speed, y, 0.0, speed, 0.0, 0.0};
        sample.is_hidden = is_hidden;
        object.motion.Add(sample);
      }
      truth_.objects.push_back(object);
    };
    add(1, 20.0, 0.0, 8.0, false);
    add(2, 20.0, 4.0, 0.0, false);
    add(3, 40.0, 0.0, 8.0, true);
    for (int k = 0; k < 3; ++k) {
      evaluation::TruthSample ego;
      ego.stamp = FromMicros(50'000 * k);
      ego.motion = {0.5 * k, 0.0, 0.0, 10.0, 0.0, 0.0};
      truth_.ego.Add(ego);
    }
  }

  static radar_detection_t At(double x_m, double y_m, double rate_mps) {
    radar_detection_t d{};
    d.range_m = std::hypot(x_m, y_m);
    d.azimuth_rad = std::atan2(y_m, x_m);
    d.range_rate_mps = rate_mps;
    return d;
  }

  evaluation::Truth truth_;
  RadarConfig radar_;
  CameraConfig camera_;
};

TEST_F(Labels, AReturnBelongsToTheBoxItIsInAndMovesWith) {
  radar_scan_t scan{};
  const double aside = 10.0 * std::cos(std::atan2(4.0, 19.0));
  scan.detections = {
      At(17.8, 0.1, -2.0),    // The first's rear.
      At(20.0, 0.3, -2.0),    // Under it.
      At(19.0, 4.0, -aside),  // The second, which stands.
      At(20.0, 0.0, -10.0),   // A post where the first is: it stands.
      At(25.0, 0.0, -2.0),    // An image behind it.
      At(40.0, 0.0, -2.0),    // The hidden one cannot answer.
  };
  EXPECT_THAT(LabelScan(truth_, radar_, scan), ElementsAre(1, 1, 2, kNobody, kNobody, kNobody));
}

TEST_F(Labels, ABoxBelongsToTheSilhouetteItCovers) {
  camera_detections_t picture{};
  const auto box = [&](double left_m, double right_m, double range_m) {
    camera_box_t b{};
    b.left_px = camera_.cx_px - camera_.fx_px * left_m / range_m;
    b.width_px = camera_.fx_px * (left_m - right_m) / range_m;
    return b;
  };
  picture.boxes = {box(0.9, -0.9, 17.75), box(4.9, 3.1, 17.75), box(-3.0, -5.0, 17.75)};
  EXPECT_THAT(LabelPicture(truth_, camera_, picture), ElementsAre(1, 2, kNobody));
}

TEST_F(Labels, WithoutAnEgoPoseNothingIsLabelled) {
  radar_scan_t scan{};
  scan.utime = 5'000'000;
  scan.detections = {At(17.8, 0.1, -2.0)};
  EXPECT_THAT(LabelScan(truth_, radar_, scan), ElementsAre(kNobody));
}

}  // namespace
}  // namespace v2vouch::ladder
