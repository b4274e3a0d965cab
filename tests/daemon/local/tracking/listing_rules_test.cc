// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/listing_rules.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const Timestamp kNow = FromMicros(1'700'000'000'000'000);

// A car that three pictures and a radar have measured, the last one just now.
struct Car {
  Car() {
    PoseMeasurement z{.x_m = 20.0, .speed_mps = 10.0};
    z.covariance.diagonal() << 0.25, 0.25, 0.0025, 0.25, 0.0004;
    evidence.filter = TrackFilter::FromPose(z);
    evidence.last_hit = kNow;
    track.start = kNow - FromSeconds(2.0);
    track.existence = 0.99;
    for (int k = 0; k < 3; ++k) track.support.Add({SensorKind::kCamera, 0}, kNow);
    track.support.Add({SensorKind::kRadar, 0}, kNow);
  }
  LocalTrack track;
  TrackEvidence evidence;
};

bool IsListed(Car& car, Timestamp now = kNow) {
  ListingRules(TrackerConfig{}).Judge(now, car.track, car.evidence);
  return car.track.is_confirmed;
}

TEST(ListingRules, ACarOfPicturesAndRadarIsListed) {
  Car car;
  EXPECT_TRUE(IsListed(car));
}

TEST(ListingRules, WhatWasNeverInAPictureNorInMotionIsNotListed) {
  Car post;
  post.track.support = {};
  for (int k = 0; k < 50; ++k) post.track.support.Add({SensorKind::kRadar, 0}, kNow);
  post.evidence.is_apart = true;
  post.evidence.clear_hits = 50;
  EXPECT_FALSE(IsListed(post));
  post.evidence.moving_hits = 2;
  EXPECT_TRUE(IsListed(post));
}

TEST(ListingRules, WhatACameraSeesThroughLeavesTheList) {
  Car image;
  image.track.support = {};
  for (int k = 0; k < 50; ++k) image.track.support.Add({SensorKind::kRadar, 0}, kNow);
  image.track.is_confirmed = true;
  EXPECT_TRUE(IsListed(image));
  image.evidence.seen_through = 3;
  EXPECT_FALSE(IsListed(image));
}

TEST(ListingRules, InViewATrackIsListedForSevenTenthsOfASecondAfterItsLastHit) {
  Car car;
  ASSERT_TRUE(IsListed(car));
  EXPECT_TRUE(IsListed(car, kNow + FromSeconds(0.65)));
  Car hidden = car;
  hidden.track.visibility = Visibility::kHidden;
  EXPECT_TRUE(IsListed(hidden, kNow + FromSeconds(0.75)));
  EXPECT_FALSE(IsListed(car, kNow + FromSeconds(0.75)));
}

// What hides a part of it makes every look fail more often, so that existence falls slowly.
TEST(ListingRules, APartlyHiddenTrackThatSensorsOughtToHaveSeenLeavesTheList) {
  Car car;
  ASSERT_TRUE(IsListed(car));
  car.track.visibility = Visibility::kHidden;
  car.evidence.missed_looks = 1.0;
  EXPECT_TRUE(IsListed(car, kNow + FromSeconds(0.5)));
  car.evidence.missed_looks = 2.0;
  EXPECT_TRUE(IsListed(car, kNow + FromSeconds(0.3)));
  EXPECT_FALSE(IsListed(car, kNow + FromSeconds(0.5)));
}

TEST(ListingRules, AHiddenTrackIsWaitedForAsLongAsItWasKnownAndNoLongerThanTheSetting) {
  const ListingRules rules{TrackerConfig{}};
  Car car;
  car.track.visibility = Visibility::kHidden;
  car.track.start = kNow - FromSeconds(0.5);  // Known for 0.5 s: held for 1.8 s.
  EXPECT_TRUE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(1.7)));
  EXPECT_FALSE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(1.9)));
  car.track.start = kNow - FromSeconds(60.0);
  EXPECT_TRUE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(7.9)));
  EXPECT_FALSE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(8.1)));
}

TEST(ListingRules, AnUnlikelyCoastingTrackEnds) {
  const ListingRules rules{TrackerConfig{}};
  Car car;
  car.track.existence = 0.4;
  EXPECT_TRUE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(0.4)));
  EXPECT_FALSE(rules.MayCoast(car.track, car.evidence, kNow + FromSeconds(0.6)));
}

}  // namespace
}  // namespace v2vouch
