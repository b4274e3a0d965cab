// SPDX-License-Identifier: Apache-2.0
// Each block of `change` on a car that drives east at 10 m/s without receiver errors.
#include "sim/attacks/change.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/sensors/bsm.h"

namespace v2vouch::sim {
namespace {

Scenario OneCar() {
  Scenario scenario;
  scenario.duration_s = 20.0;
  scenario.routes.push_back({"road", {{0, 0, 10}, {1000, 0, 10}}, 4.0});
  scenario.ego.drive.route = "road";
  scenario.ego.drive.speed_mps = 10.0;
  VehicleSpec car;
  car.id = 1;
  car.v2v = true;
  car.drive = {.route = "road", .start_m = 50.0, .offset_m = 1.0, .speed_mps = 10.0};
  scenario.vehicles.push_back(car);
  return scenario;
}

class Blocks : public testing::Test {
 protected:
  Blocks() {
    std::vector<std::string> problems;
    world_ = World::Make(OneCar(), 1, problems);
    line_.emplace(*world_);
    scene_.emplace(AttackScene{*world_, 1, *line_, nullptr});
  }

  Change Make(const ChangeSpec& spec) { return {spec, *scene_, {1, 1000, &heard_}, Random(7)}; }

  // The car's honest message at a time.
  [[nodiscard]] Message Honest(double time_s) const {
    Message message;
    message.said = TrueStatement(world_->actors()[0], time_s);
    message.time_s = message.stamp_s = message.signed_s = time_s;
    message.honest = message.said;
    message.device = message.vehicle = 1;
    message.msg_count = static_cast<int>(std::lround(time_s * 10.0)) % 128;
    message.identity = IdentityOf(1, 1, 0);
    return message;
  }

  Message Pass(Change& change, double time_s) {
    Message message = Honest(time_s);
    change.Pass({time_s, time_s - 5.0, 0, 10.0, {}, nullptr}, message);
    return message;
  }

  // How far what is said is from the truth at that time, ahead and to the left.
  [[nodiscard]] Vec2 Off(const Message& message) const {
    return message.said.centre - TrueStatement(world_->actors()[0], message.time_s).centre;
  }

  std::unique_ptr<World> world_;
  std::optional<EgoLine> line_;
  std::optional<AttackScene> scene_;
  Heard heard_;
};

TEST_F(Blocks, OffsetAddsItsPartsAndDrawsOnceOrPerMessage) {
  ChangeSpec spec;
  spec.offset = OffsetSpec{.along_m = 2.0, .left_m = 3.0, .east_m = 0.5, .north_m = -1.0};
  Change fixed = Make(spec);
  EXPECT_NEAR((Off(Pass(fixed, 5.0)) - Vec2(2.5, 2.0)).norm(), 0.0, 1e-9);
  spec.offset = OffsetSpec{.low_m = 20.0, .high_m = 70.0};
  Change once = Make(spec);
  const Vec2 first = Off(Pass(once, 5.0));
  EXPECT_NEAR((Off(Pass(once, 6.0)) - first).norm(), 0.0, 1e-9);
  EXPECT_GE(std::abs(first.x()), 20.0);
  EXPECT_LE(std::abs(first.x()), 70.0);
  EXPECT_GE(std::abs(first.y()), 20.0);
  spec.offset->draw = Draw::kPerMessage;
  Change each = Make(spec);
  EXPECT_GT((Off(Pass(each, 5.0)) - Off(Pass(each, 5.1))).norm(), 0.1);
  spec.offset = OffsetSpec{.distance_m = 10.0};
  Change jump = Make(spec);
  EXPECT_NEAR(Off(Pass(jump, 5.0)).norm(), 10.0, 1e-9);
}

TEST_F(Blocks, DriftGrowsFromZeroToItsLimitWithMatchingVelocity) {
  ChangeSpec spec;
  spec.drift = DriftSpec{.left_mps = 1.0, .limit_m = 3.0};
  Change change = Make(spec);
  EXPECT_NEAR(Off(Pass(change, 5.0)).norm(), 0.0, 1e-9);
  const Message later = Pass(change, 7.0);
  EXPECT_NEAR((Off(later) - Vec2(0.0, 2.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR(later.said.speed_mps, std::hypot(10.0, 1.0), 1e-6);
  EXPECT_NEAR(later.said.yaw_rad, std::atan2(1.0, 10.0), 1e-6);
  EXPECT_TRUE(later.is_attack);
  const Message after = Pass(change, 12.0);
  EXPECT_NEAR(Off(after).y(), 3.0, 1e-6);
  EXPECT_NEAR(after.said.speed_mps, 10.0, 1e-6);
}

TEST_F(Blocks, BrakeStopsFromTheSpeedClaimedAndStays) {
  ChangeSpec spec;
  spec.brake = BrakeSpec{.decel_mps2 = 4.0};
  Change change = Make(spec);
  const double begin = Pass(change, 5.0).said.centre.x();
  const Message middle = Pass(change, 6.0);
  EXPECT_NEAR(middle.said.centre.x() - begin, 10.0 - 2.0, 1e-6);
  EXPECT_NEAR(middle.said.speed_mps, 6.0, 1e-6);
  EXPECT_NEAR(middle.said.accel_mps2, -4.0, 1e-9);
  const Message end = Pass(change, 15.0);
  EXPECT_NEAR(end.said.centre.x() - begin, 10.0 * 10.0 / 8.0, 1e-6);  // v^2 / 2 a.
  EXPECT_NEAR(end.said.speed_mps, 0.0, 1e-9);
}

TEST_F(Blocks, FreezeHoldsWhatItIsToldTo) {
  ChangeSpec spec;
  spec.freeze = FreezeSpec{};
  Change change = Make(spec);
  const Vec2 first = Pass(change, 5.0).said.centre;
  const Message later = Pass(change, 9.0);
  EXPECT_EQ(later.said.centre, first);
  EXPECT_NEAR(later.said.speed_mps, 10.0, 1e-6);
}

TEST_F(Blocks, EventualStopIsNoAttackUntilItStops) {
  ChangeSpec spec;
  spec.eventual_stop = EventualStopSpec{.probability = 0.0, .growth = 0.025};
  Change change = Make(spec);
  EXPECT_FALSE(Pass(change, 5.0).is_attack);
  Message last;
  for (int k = 1; k <= 41; ++k) last = Pass(change, 5.0 + 0.1 * k);  // Certain after 40.
  EXPECT_TRUE(last.is_attack);
  EXPECT_EQ(last.said.speed_mps, 0.0);
  EXPECT_EQ(Pass(change, 12.0).said.centre, last.said.centre);
}

TEST_F(Blocks, MirrorGoesAcrossTheRoutesCentreLine) {
  ChangeSpec spec;
  spec.mirror = MirrorSpec{};
  Change by_route = Make(spec);
  // The centre line is 4 m left of the route, the car 1 m: 3 m, there and as far again.
  EXPECT_NEAR((Off(Pass(by_route, 5.0)) - Vec2(0.0, 6.0)).norm(), 0.0, 1e-6);
  spec.mirror->centre_left_m = 1.0;
  Change by_hand = Make(spec);
  EXPECT_NEAR(Off(Pass(by_hand, 5.0)).y(), 2.0, 1e-6);
}

TEST_F(Blocks, RotateTurnsThePlaceAloneAboutTheEgosRearAxle) {
  ChangeSpec spec;
  spec.rotate = RotateSpec{.about_ego_rad = 0.5 * kPi};
  Change change = Make(spec);
  const Message turned = Pass(change, 5.0);
  const Message honest = Honest(5.0);
  const Vec2 axle = world_->At(5.0).ego.axle;
  const Vec2 way = honest.said.centre - axle;
  EXPECT_NEAR((turned.said.centre - axle - Vec2(-way.y(), way.x())).norm(), 0.0, 1e-9);
  EXPECT_EQ(turned.said.yaw_rad, honest.said.yaw_rad);
  EXPECT_EQ(turned.said.speed_mps, honest.said.speed_mps);
  EXPECT_TRUE(turned.is_attack);
  EXPECT_GT(way.norm(), 10.0);  // Else it would be no test.
}

TEST_F(Blocks, SpeedHeadingAccelerationSizeAndAccuracyAreWhatTheyAreSetTo) {
  ChangeSpec spec;
  spec.speed.emplace();
  spec.speed->scale = 0.5;
  spec.speed->low_mps = 3.0;
  spec.speed->high_mps = 3.0;
  Change speed = Make(spec);
  EXPECT_NEAR(std::abs(Pass(speed, 5.0).said.speed_mps - 5.0), 3.0, 1e-6);
  spec = {};
  spec.heading = HeadingChangeSpec{.add_rad = 1.0, .per_message_rad = 0.25};
  Change heading = Make(spec);
  EXPECT_NEAR(Pass(heading, 5.0).said.yaw_rad, 1.25, 1e-6);
  EXPECT_NEAR(Pass(heading, 5.1).said.yaw_rad, 1.5, 1e-6);
  spec = {};
  spec.acceleration =
      AccelerationChangeSpec{.set_mps2 = -4.6, .brakes = AccelerationChangeSpec::Lights::kOn};
  Change acceleration = Make(spec);
  EXPECT_EQ(Pass(acceleration, 5.0).said.accel_mps2, -4.6);
  EXPECT_EQ(Pass(acceleration, 5.0).said.brakes, Brakes::kOn);
  spec = {};
  spec.size = SizeChangeSpec{.scale = 2.0, .swap = true};
  Change size = Make(spec);
  EXPECT_NEAR(Pass(size, 5.0).said.length_m, 3.6, 1e-9);
  EXPECT_NEAR(Pass(size, 5.0).said.width_m, 9.0, 1e-9);
  spec = {};
  spec.accuracy = AccuracySpec{.unavailable = true};
  Change accuracy = Make(spec);
  EXPECT_TRUE(std::isnan(Pass(accuracy, 5.0).said.semi_major_m));
}

TEST_F(Blocks, DelayKeepsTheContentsStampsUnlessTold) {
  ChangeSpec spec;
  spec.delay = DelaySpec{.low_s = 2.0, .high_s = 2.0};
  Change honest_stamps = Make(spec);
  spec.delay->restamp = true;
  Change fresh_stamps = Make(spec);
  Message kept, fresh;
  for (int k = 0; k <= 40; ++k) {
    kept = Pass(honest_stamps, 5.0 + 0.1 * k);
    fresh = Pass(fresh_stamps, 5.0 + 0.1 * k);
  }
  EXPECT_NEAR(kept.stamp_s, 7.0, 0.11);  // 9 s less 2 s; messages come every 0.1 s.
  EXPECT_NEAR(Off(kept).x(), -20.0, 1.1);
  EXPECT_EQ(fresh.stamp_s, 9.0);
  EXPECT_EQ(fresh.said.centre, kept.said.centre);
  // Nothing is so old yet: reckoned back from the oldest.
  Change early = Make(spec);
  EXPECT_NEAR(Off(Pass(early, 5.0)).x(), -20.0, 1e-6);
}

TEST_F(Blocks, ReplayOfOwnMessagesIsBitForBit) {
  ChangeSpec spec;
  spec.replay = ReplaySpec{.age_s = 0.95};  // Nothing is just so old: the one before.
  Change change = Make(spec);
  const MessageWriter writer(world_->scenario());
  std::vector<bsm_t> honest;
  Message replayed;
  for (int k = 0; k <= 30; ++k) {
    honest.push_back(writer.Encode(Honest(5.0 + 0.1 * k)));
    replayed = Pass(change, 5.0 + 0.1 * k);
  }
  const bsm_t again = writer.Encode(replayed);
  const bsm_t& then = honest[20];
  EXPECT_EQ(again.lat, then.lat);
  EXPECT_EQ(again.long_, then.long_);
  EXPECT_EQ(again.msgCnt, then.msgCnt);
  EXPECT_EQ(again.secMark, then.secMark);
  EXPECT_EQ(again.generation_utime, then.generation_utime);
  EXPECT_GT(again.rx_utime, then.rx_utime + 900000);
  spec.replay = ReplaySpec{.age_s = 60.0, .stamps = ReplaySpec::Stamps::kMinute};
  Change minute = Make(spec);
  const bsm_t old = writer.Encode(Pass(minute, 5.0));
  EXPECT_EQ(old.secMark, honest[0].secMark);
  EXPECT_EQ(old.generation_utime, honest[0].generation_utime - 60000000);
}

TEST_F(Blocks, IdentityChangesByMessagesAndTakesACountOfItsOwn) {
  ChangeSpec spec;
  spec.identity = IdentityChangeSpec{.every_messages = 3};
  Change change = Make(spec);
  std::vector<Message> said;
  for (int k = 0; k < 9; ++k) said.push_back(Pass(change, 5.0 + 0.1 * k));
  EXPECT_EQ(said[2].identity.id, said[0].identity.id);
  EXPECT_FALSE(said[2].is_attack);
  EXPECT_NE(said[3].identity.id, said[2].identity.id);
  EXPECT_NE(said[3].identity.certificate, said[2].identity.certificate);
  EXPECT_EQ(said[5].identity.id, said[3].identity.id);
  EXPECT_NE(said[6].identity.id, said[5].identity.id);
  EXPECT_EQ(said[4].msg_count, (said[3].msg_count + 1) % 128);
}

TEST_F(Blocks, ABlocksOwnGateCountsFromTheAttacksBeginning) {
  ChangeSpec spec;
  spec.offset = OffsetSpec{.left_m = 3.0};
  spec.when.after_s = 2.0;
  Change change = Make(spec);  // The attack began at 5 s.
  EXPECT_FALSE(Pass(change, 6.9).is_attack);
  EXPECT_NEAR(Off(Pass(change, 7.0)).y(), 3.0, 1e-6);
}

}  // namespace
}  // namespace v2vouch::sim
