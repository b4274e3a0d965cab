// SPDX-License-Identifier: Apache-2.0
#include "sim/import/kitti.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "daemon/rim/wire/codec.h"
#include "sim/import/kitti_events.h"
#include "tests/sim/import/files.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::sim {
namespace {

using ::testing::HasSubstr;

constexpr char kLabelLine[] =
    "3 7 Car 0.1 1 -1.5 100 150 200 210.5 1.5 1.8 4.2 -2.0 1.6 20.0 -1.57\n";
constexpr KittiCamera kCamera{721.5, 721.5, 609.5, 172.9, 0.06};

TEST(KittiLabels, ColumnsOfTheDevelopmentKit) {
  const ScratchFolder folder("kitti");
  std::vector<KittiLabel> labels;
  std::string error;
  const std::string path =
      folder.Write("a.txt", "3 -1 DontCare -1 -1 -10 0 0 9 9 -1000 -1000 -1000 -10 -1 -1 -1\n" +
                                std::string(kLabelLine));
  ASSERT_TRUE(ReadKittiLabels(path, labels, error)) << error;
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_EQ(labels[0].frame, 3);
  EXPECT_EQ(labels[0].track, 7);
  EXPECT_EQ(labels[0].type, "Car");
  EXPECT_EQ(labels[0].occluded, 1);
  EXPECT_EQ(labels[0].bottom_px, 210.5);
  EXPECT_EQ(labels[0].length_m, 4.2);
  EXPECT_EQ(labels[0].z_m, 20.0);
  EXPECT_EQ(labels[0].rotation_y_rad, -1.57);
}

TEST(KittiLabels, FaultsNameFileAndLine) {
  const ScratchFolder folder("kitti");
  std::vector<KittiLabel> labels;
  std::string error;
  EXPECT_FALSE(ReadKittiLabels("/nowhere.txt", labels, error));
  EXPECT_EQ(error, "/nowhere.txt: cannot be read");
  const std::pair<const char*, const char*> faults[] = {
      {"3 7 Car 0.1 1\n", ":1: has 5 columns; a tracking label has 17"},
      {"x 7 Car 0 1 -1.5 100 150 200 210 1.5 1.8 4.2 -2 1.6 20 -1.57\n", ":1: is no label"},
      {"3 7 Car 0 9 -1.5 100 150 200 210 1.5 1.8 4.2 -2 1.6 20 -1.57\n", ":1: is no label"},
      {"3 7 Car 0 1 -1.5 200 150 100 210 1.5 1.8 4.2 -2 1.6 20 -1.57\n", ":1: is no label"},
      {"3 7 Car 0 1 -1.5 100 150 200 210 1.5 0 4.2 -2 1.6 20 nan\n", ":1: is no label"},
      {"3 7 Car 0 1 -1.5 100 150 200 210 1.5 0 4.2 -2 1.6 20 0\n", ":1: an object without size"},
      {"\n", ": holds no labelled object"}};
  for (const auto& [text, fault] : faults) {
    EXPECT_FALSE(ReadKittiLabels(folder.Write("b.txt", text), labels, error)) << text;
    EXPECT_THAT(error, HasSubstr(fault));
  }
}

TEST(KittiCamera, FromTheLineP2) {
  const ScratchFolder folder("kitti");
  KittiCamera camera;
  std::string error;
  ASSERT_TRUE(ReadKittiCamera(
      folder.Write("c.txt", "P1: 1\nP2: 721.5 0 609.6 44.86 0 722.5 172.9 0.2 0 0 1 0.003\n"),
      camera, error));
  EXPECT_EQ(camera.fx_px, 721.5);
  EXPECT_EQ(camera.fy_px, 722.5);
  EXPECT_EQ(camera.cx_px, 609.6);
  EXPECT_EQ(camera.cy_px, 172.9);
  EXPECT_NEAR(camera.shift_x_m, 0.0622, 1e-4);
  EXPECT_FALSE(ReadKittiCamera(folder.Write("d.txt", "P2: 721.5 0 x\n"), camera, error));
  EXPECT_THAT(error, HasSubstr(":1: P2 is no projection"));
  EXPECT_FALSE(ReadKittiCamera(folder.Write("e.txt", "P1: 1\n"), camera, error));
  EXPECT_THAT(error, HasSubstr("has no line P2:"));
}

TEST(KittiOxts, ForwardVelocityAndTurn) {
  const ScratchFolder folder("kitti");
  std::string line = "49 8 112 0 0 0 0 0 13.5";
  for (int i = 9; i < 30; ++i) line += i == 22 ? " -0.25" : " 0";
  std::vector<KittiMotion> motion;
  std::string error;
  ASSERT_TRUE(ReadKittiOxts(folder.Write("o.txt", line + "\n" + line + "\n"), motion, error));
  ASSERT_EQ(motion.size(), 2u);
  EXPECT_EQ(motion[1].speed_mps, 13.5);
  EXPECT_EQ(motion[1].yaw_rate_radps, -0.25);
  EXPECT_FALSE(ReadKittiOxts(folder.Write("p.txt", "1 2 3\n"), motion, error));
  EXPECT_THAT(error, HasSubstr(":1: is no line of oxts"));
}

// A car that drives an arc of known speed and turn past standing cars, one moving among them.
std::vector<KittiLabel> Arc(double speed_mps, double yaw_rate_radps, int frames,
                            double camera_x_m) {
  std::vector<KittiLabel> labels;
  const double places[][2] = {{15, 4}, {22, -5}, {30, 6}, {38, -4}, {45, 3}};
  for (int k = 0; k < frames; ++k) {
    const double t = 0.1 * k;
    const double yaw = yaw_rate_radps * t;
    const double ego_x = std::sin(yaw) * speed_mps / yaw_rate_radps;
    const double ego_y = (1.0 - std::cos(yaw)) * speed_mps / yaw_rate_radps;
    int track = 0;
    const auto add = [&](double x, double y, double direction) {
      KittiLabel label;
      label.frame = k;
      label.track = track++;
      label.type = "Car";
      label.left_px = 600;
      label.right_px = 640;
      label.top_px = 180;
      label.bottom_px = 210;
      label.height_m = 1.5;
      label.width_m = 1.8;
      label.length_m = 4.2;
      const double forward = std::cos(yaw) * (x - ego_x) + std::sin(yaw) * (y - ego_y);
      const double left = -std::sin(yaw) * (x - ego_x) + std::cos(yaw) * (y - ego_y);
      label.z_m = forward - camera_x_m;
      label.x_m = -left - kCamera.shift_x_m;
      label.rotation_y_rad = -(direction - yaw) - std::numbers::pi / 2.0;
      labels.push_back(label);
    };
    for (const auto& place : places) add(place[0], place[1], 0.0);
    add(20.0 + 14.0 * t, 0.0, 0.0);
  }
  return labels;
}

TEST(KittiMotion, ArcPastStandingCarsIsFound) {
  const KittiOptions options;
  const auto motion =
      KittiMotionFromLabels(Arc(8.0, 0.2, 15, options.camera_x_m), kCamera, options.camera_x_m);
  ASSERT_EQ(motion.size(), 15u);
  for (std::size_t k = 3; k < 12; ++k) {
    EXPECT_NEAR(motion[k].speed_mps, 8.0, 0.05) << k;
    EXPECT_NEAR(motion[k].yaw_rate_radps, 0.2, 0.003) << k;
    EXPECT_TRUE(motion[k].is_measured);
  }
}

TEST(KittiMotion, WithoutThreeThatAgreeThereIsNone) {
  auto labels = Arc(8.0, 0.2, 5, 1.13);
  std::erase_if(labels, [](const KittiLabel& label) { return label.track > 1; });
  EXPECT_TRUE(KittiMotionFromLabels(labels, kCamera, 1.13).empty());
}

template <class Message>
std::vector<Message> All(const std::vector<ImportedEvent>& events, const std::string& channel) {
  std::vector<Message> messages;
  for (const ImportedEvent& event : events) {
    if (event.channel == channel) messages.push_back(*wire::Decode<Message>(event.bytes));
  }
  return messages;
}

TEST(KittiEvents, StandingCarsStandInTheWorldAndTheMovingOneMoves) {
  KittiOptions options;
  const auto labels = Arc(8.0, 0.2, 15, options.camera_x_m);
  const std::vector<KittiMotion> motion(15, {8.0, 0.2, true});
  const auto events = KittiEvents("test", labels, kCamera, motion, options, {});
  for (std::size_t i = 1; i < events.size(); ++i) {
    EXPECT_LE(events[i - 1].received, events[i].received);
  }
  const auto truth = All<truth_list_t>(events, "TRUTH");
  ASSERT_EQ(truth.size(), 15u);
  for (const truth_list_t& list : truth) {
    ASSERT_EQ(list.objects.size(), 6u);
    EXPECT_NEAR(list.objects[2].x_m, 30.0, 0.01);
    EXPECT_NEAR(list.objects[2].y_m, 6.0, 0.01);
    EXPECT_NEAR(list.objects[2].yaw_rad, 0.0, 0.001);
    EXPECT_NEAR(list.objects[2].speed_mps, 0.0, 0.05);
    EXPECT_NEAR(list.objects[5].speed_mps, 14.0, 0.1);
    EXPECT_EQ(list.objects[5].id, 6);
  }
  EXPECT_EQ(All<ego_motion_t>(events, "EGO_MOTION").size(), 75u);
}

TEST(KittiEvents, NoiseIsTheOneAskedForAndTheSameEveryTime) {
  KittiOptions options;
  options.edge_sigma_px = 3.0;
  options.detection_probability = 0.8;
  options.clutter_per_image = 0.0;
  const auto labels = Arc(0.5, 0.01, 200, options.camera_x_m);
  const std::vector<KittiMotion> motion(200, {0.5, 0.01, true});
  const auto events = KittiEvents("test", labels, kCamera, motion, options, {});
  double sum = 0.0;
  double count = 0.0;
  for (const auto& message : All<camera_detections_t>(events, "CAMERA_FRONT")) {
    for (const camera_box_t& box : message.boxes) {
      const double error = box.left_px - 600.0;
      sum += error * error;
      ++count;
      EXPECT_EQ(box.class_name, "car");
    }
  }
  EXPECT_NEAR(count / (6.0 * 200.0), 0.8, 0.04);   // 3.5 sigma of 1200 draws.
  EXPECT_NEAR(std::sqrt(sum / count), 3.0, 0.25);  // The same.
  const auto again = KittiEvents("test", labels, kCamera, motion, options, {});
  ASSERT_EQ(again.size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(again[i].bytes, events[i].bytes);
}

TEST(KittiEvents, PicturesGoInWhereTheyAre) {
  const KittiOptions options;
  const std::vector<KittiMotion> motion(5, {8.0, 0.2, true});
  const auto events =
      KittiEvents("test", {}, kCamera, motion, options, [](int frame) -> std::vector<std::uint8_t> {
        if (frame % 2 == 0) return {};
        return {0xFF, 0xD8, static_cast<std::uint8_t>(frame)};
      });
  const auto pictures = All<camera_image_t>(events, "CAMERA_FRONT_IMAGE");
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(pictures[1].seq, 3);
  EXPECT_EQ(pictures[1].data[2], 3);
  EXPECT_EQ(pictures[1].encoding, "jpeg");
  EXPECT_TRUE(All<camera_detections_t>(events, "CAMERA_FRONT").empty());
}

}  // namespace
}  // namespace v2vouch::sim
