// SPDX-License-Identifier: Apache-2.0
// object_list_t: every figure that is unknown or cannot be costs itself alone, an object without a
// position costs itself, and a list of another sensor or time is refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::int64_t kUtime = 1'700'000'000'000'000;
constexpr Timestamp kReceived = FromMicros(kUtime + 30'000);

object_t Car() {
  object_t car{};
  car.x_m = 20.0;
  car.y_m = -3.0;
  car.yaw_rad = 0.1;
  car.has_front = 1;
  car.length_m = 4.4;
  car.width_m = 1.8;
  car.height_m = 1.5;
  car.velocity_x_mps = 9.0;
  car.velocity_y_mps = 1.0;
  for (int i = 0; i < 5; ++i) car.covariance[6 * i] = 0.04;
  car.covariance[1] = car.covariance[5] = 0.01;
  car.class_name = "car";
  car.score = 0.8;
  car.id = 17;
  return car;
}

object_list_t List(std::vector<object_t> objects) {
  object_list_t list{};
  list.utime = kUtime;
  list.seq = 5;
  list.sensor = "LIDAR";
  list.objects = std::move(objects);
  list.num_objects = static_cast<std::int32_t>(list.objects.size());
  return list;
}

struct Converted {
  Result<ObjectList> list = Reason::kCount;
  RefusalTally dropped;

  [[nodiscard]] std::string Counted() const {
    std::string text;
    for (const RefusalTally::Entry& entry : dropped.entries()) {
      if (!text.empty()) text += ", ";
      text += std::string(ReasonName(entry.refusal.reason)) + " " +
              std::string(entry.refusal.field) + (entry.text.empty() ? "" : " " + entry.text);
    }
    return text;
  }
};

Converted Convert(const object_list_t& message, ObjectSensorConfig source = {}) {
  Converted out;
  out.list = FromWire(message, source, 2, kReceived, out.dropped);
  return out;
}

Converted ConvertCar(const std::function<void(object_t&)>& spoil) {
  object_t car = Car();
  spoil(car);
  return Convert(List({car}));
}

TEST(ObjectListFromWire, TakesAWholeObject) {
  const Converted out = Convert(List({Car()}), {.clock_offset_s = 0.01});
  ASSERT_TRUE(out.list);
  EXPECT_EQ(out.Counted(), "");
  EXPECT_EQ(out.list->stamp, FromMicros(kUtime + 10'000));
  EXPECT_EQ(out.list->sensor, 2);
  ASSERT_EQ(out.list->objects.size(), 1U);
  const ObjectBox& object = out.list->objects[0];
  EXPECT_EQ(object.x_m, 20.0);
  EXPECT_TRUE(object.has_yaw && object.has_front && object.has_size);
  EXPECT_EQ(object.velocity_mps->x(), 9.0);
  EXPECT_EQ(object.position_covariance(0, 1), 0.01);
  EXPECT_EQ(object.yaw_sigma_rad, 0.2);
  EXPECT_EQ(object.velocity_covariance(1, 1), 0.04);
  EXPECT_EQ(object.object_class, ObjectClass::kCar);
  EXPECT_EQ(object.id, 17);
}

TEST(ObjectListFromWire, UnknownFiguresAreTakenAsUnknownWithoutACount) {
  const Converted out = ConvertCar([](object_t& car) {
    car.yaw_rad = car.length_m = car.velocity_x_mps = car.score = kNaN;
    car.width_m = 0.0;
    for (double& entry : car.covariance) entry = kNaN;
    car.class_name = "";
    car.id = -5;
  });
  ASSERT_TRUE(out.list);
  EXPECT_EQ(out.Counted(), "");
  const ObjectBox& object = out.list->objects.at(0);
  EXPECT_FALSE(object.has_yaw || object.has_front || object.has_size);
  EXPECT_FALSE(object.velocity_mps);
  EXPECT_TRUE(object.position_covariance.isZero());
  EXPECT_EQ(object.yaw_sigma_rad, 0.0);
  EXPECT_EQ(object.score, 1.0);
  EXPECT_EQ(object.id, -1);
}

TEST(ObjectListFromWire, AFigureThatCannotBeIsLeftUnusedByName) {
  struct Case {
    std::function<void(object_t&)> spoil;
    const char* counted;
  };
  const std::vector<Case> cases = {
      {[](object_t& c) { c.yaw_rad = 90.0; }, "field_unused objects.yaw_rad looks like degrees"},
      {[](object_t& c) { c.yaw_rad = 1e9; }, "field_unused objects.yaw_rad"},
      {[](object_t& c) { c.has_front = 7; }, "field_unused objects.has_front"},
      {[](object_t& c) { c.length_m = 450.0; }, "field_unused objects.length_m"},
      {[](object_t& c) { c.length_m = -4.5; }, "field_unused objects.length_m"},
      {[](object_t& c) { c.width_m = 1e300; }, "field_unused objects.width_m"},
      {[](object_t& c) { c.velocity_x_mps = kInf; }, "field_unused objects.velocity_x_mps"},
      {[](object_t& c) { c.velocity_y_mps = -900.0; }, "field_unused objects.velocity_y_mps"},
      {[](object_t& c) { c.covariance[0] = -1.0; }, "field_unused objects.covariance"},
      {[](object_t& c) { c.covariance[18] = 1e9; }, "field_unused objects.covariance"},
      {[](object_t& c) { c.covariance[1] = 0.9; }, "field_unused objects.covariance"},
      {[](object_t& c) { c.covariance[1] = c.covariance[5] = 0.04; },
       "field_unused objects.covariance"},
      {[](object_t& c) { c.score = 87.0; }, "field_unused objects.score looks like percent"},
      {[](object_t& c) { c.score = -2.0; }, "field_unused objects.score"},
      {[](object_t& c) { c.class_name = "forklift"; }, "field_unused objects.class_name forklift"},
  };
  for (const Case& each : cases) {
    const Converted out = ConvertCar(each.spoil);
    ASSERT_TRUE(out.list) << each.counted;
    EXPECT_EQ(out.list->objects.size(), 1U) << each.counted;
    EXPECT_EQ(out.Counted(), each.counted);
  }
}

TEST(ObjectListFromWire, AnObjectWithoutPositionOrOfNoRoadUserCostsItselfAlone) {
  for (const double bad : {kNaN, kInf, -kInf, 1e6}) {
    object_t lost = Car();
    lost.y_m = bad;
    const Converted out = Convert(List({lost, Car()}));
    ASSERT_TRUE(out.list);
    EXPECT_EQ(out.list->objects.size(), 1U);
    EXPECT_NE(out.Counted().find("objects.y_m"), std::string::npos);
  }
  const Converted out = ConvertCar([](object_t& car) { car.class_name = "traffic light"; });
  EXPECT_EQ(out.list->objects.size(), 0U);
  EXPECT_EQ(out.Counted(), "out_of_range objects.class_name traffic light");
}

TEST(ObjectListFromWire, AnotherSensorsNameOrAnImpossibleTimeRefusesTheList) {
  object_list_t other = List({Car()});
  other.sensor = "REAR";
  EXPECT_EQ(Convert(other).list.refusal(), (Refusal{Reason::kSensorMismatch, "sensor"}));
  other.sensor = "";
  EXPECT_TRUE(Convert(other).list);
  object_list_t early = List({Car()});
  early.utime = kUtime / 1000;
  EXPECT_EQ(Convert(early).list.refusal(),
            (Refusal{Reason::kOutOfRange, "utime looks like milliseconds"}));
}

}  // namespace
}  // namespace v2vouch::wire
