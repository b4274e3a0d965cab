// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/class_names.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "daemon/rim/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

TEST(ClassNames, DialectsOfDetectorsAndDataSetsAreUnderstood) {
  const std::vector<std::pair<ObjectClass, std::vector<const char*>>> names{
      {ObjectClass::kCar,
       {"car", "Car", "CAR", " car ", "vehicle.car", "passenger_car", "Sedan", "taxi", "police car",
        "2", "PKW"}},
      {ObjectClass::kVan, {"van", "Van", "vehicle.emergency.ambulance", "pickup truck", "minivan"}},
      {ObjectClass::kTruck,
       {"truck", "Truck", "lorry", "LORRY", "vehicle.truck", "vehicle.trailer",
        "vehicle.construction", "construction_vehicle", "fire truck", "7", "LKW"}},
      {ObjectClass::kBus,
       {"bus", "BUS", "vehicle.bus.bendy", "vehicle.bus.rigid", "Tram", "train", "school-bus",
        "5"}},
      {ObjectClass::kMotorcycle,
       {"motorcycle", "motorbike", "Motor", "vehicle.motorcycle", "motor cycle", "3", "moped"}},
      {ObjectClass::kCyclist,
       {"cyclist", "Cyclist", "bicycle", "bike", "vehicle.bicycle", "TYPE_CYCLIST", "rider", "1"}},
      {ObjectClass::kPedestrian,
       {"pedestrian", "Pedestrian", "person", "Person_sitting", "human.pedestrian.police_officer",
        "TYPE_PEDESTRIAN", "0"}},
  };
  for (const auto& [object_class, written] : names) {
    for (const char* name : written) {
      EXPECT_EQ(MeaningOf(name), (NamedClass{object_class, true, true})) << name;
    }
  }
}

TEST(ClassNames, SomeNamesLeaveTheClassOpenAndNobodyIsToldOfThem) {
  for (const char* name : {"", "vehicle", "Vehicle", "TYPE_VEHICLE", "unknown", "Misc", "other"}) {
    EXPECT_EQ(MeaningOf(name), (NamedClass{ObjectClass::kUnknown, true, true})) << name;
  }
}

TEST(ClassNames, OthersAreUnknown) {
  for (const char* name : {"forklift", "Zug", "x", "cart", "carpet", "80", "4", "-2", "2.0", "???",
                           "\xff\xfe", "99999999999999999999"}) {
    EXPECT_EQ(MeaningOf(name), NamedClass{}) << name;
  }
  EXPECT_EQ(MeaningOf(std::string(5000, 'a')), NamedClass{});
  EXPECT_EQ(MeaningOf(std::string(5000, ' ') + "car"), NamedClass{});
}

TEST(ClassNames, WhatIsNoRoadUserIsTold) {
  for (const char* name : {"traffic light", "stop sign", "DontCare", "movable_object.trafficcone",
                           "static_object.bicycle_rack", "bus stop", "dog", "fire hydrant"}) {
    EXPECT_FALSE(MeaningOf(name).is_road_user) << name;
  }
}

TEST(ClassNames, ABoxOfAnUnknownNameStaysAndItsNameIsTold) {
  CameraConfig camera;
  camera.name = "FRONT";
  camera_detections_t message{};
  message.utime = 1'700'000'000'000'000;
  for (const char* name : {"Car", "forklift", "forklift", "dog", "fork'lift\n"}) {
    camera_box_t box{};
    box.left_px = 10.0;
    box.top_px = 10.0;
    box.width_px = 50.0;
    box.height_px = 40.0;
    box.score = 0.8;
    box.class_name = name;
    message.boxes.push_back(box);
  }
  message.num_boxes = static_cast<std::int32_t>(message.boxes.size());
  RefusalTally told;
  const auto picture = FromWire(message, camera, 0, FromMicros(message.utime), told);
  ASSERT_TRUE(picture);
  ASSERT_EQ(picture->boxes.size(), 4U);
  EXPECT_EQ(picture->boxes[0].object_class, ObjectClass::kCar);
  EXPECT_EQ(picture->boxes[1].object_class, ObjectClass::kUnknown);
  ASSERT_EQ(told.entries().size(), 3U);
  EXPECT_EQ(told.entries()[0].text, "forklift");
  EXPECT_EQ(told.entries()[0].count, 2U);
  EXPECT_EQ(told.entries()[0].refusal, (Refusal{Reason::kFieldUnused, "boxes.class_name"}));
  EXPECT_EQ(told.entries()[1].refusal, (Refusal{Reason::kOutOfRange, "boxes.class_name"}));
  EXPECT_EQ(told.entries()[1].text, "dog");
  EXPECT_EQ(told.entries()[2].text, "fork?lift?");
}

}  // namespace
}  // namespace v2vouch::wire
