// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch::sim {

/// One labelled object of one frame of a KITTI tracking sequence (Geiger et al. 2012). Camera frame
/// of the rectified left grey camera: x right, y down, z forward.
struct KittiLabel {
  int frame = 0;
  int track = -1;
  std::string type;  ///< Car, Van, Truck, Tram, Pedestrian, Cyclist, Misc, ...
  double truncated = 0.0;
  int occluded = 0;  ///< 0 visible, 1 partly, 2 largely hidden, 3 unknown.
  double left_px = 0.0;
  double top_px = 0.0;
  double right_px = 0.0;
  double bottom_px = 0.0;
  double height_m = 0.0;
  double width_m = 0.0;
  double length_m = 0.0;
  double x_m = 0.0;  ///< Middle of the bottom face.
  double y_m = 0.0;
  double z_m = 0.0;
  double rotation_y_rad = 0.0;  ///< About y: 0 = facing right, -pi/2 = facing ahead.
};

/// Reads a tracking label file (17 columns, 18 with a score). @return false with `error` naming
/// file, line and fault.
/// @param with_regions ignore regions (DontCare), which have a 2-D box only, too.
bool ReadKittiLabels(const std::string& path, std::vector<KittiLabel>& labels, std::string& error,
                     bool with_regions = false);

/// The left colour camera of a calibration file (line "P2:").
struct KittiCamera {
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;
  double cy_px = 0.0;
  double shift_x_m = 0.0;  ///< Added to x of the labels' frame: the colour camera sits to the left.
};

/// @return false with `error` naming file and fault.
bool ReadKittiCamera(const std::string& path, KittiCamera& camera, std::string& error);

/// The car's own motion at one frame, rear axle.
struct KittiMotion {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;  ///< Left positive.
  bool is_measured = false;     ///< False: interpolated between frames that are.
};

/// One line per frame as KITTI's GPS/IMU unit (oxts) tells it: forward velocity and yaw rate.
/// @return false with `error` naming file, line and fault.
bool ReadKittiOxts(const std::string& path, std::vector<KittiMotion>& motion, std::string& error);

/// Where there is no oxts: the motion against what stands still among the labelled objects. Between
/// frames k and k + 1 an object that stands moves from p to p' in the car's frame (x forward, y
/// left, origin at the rear axle) by
///
///     p' - p = [ -s + y a, -x a ],   (x, y) = (p + p') / 2,   s = way, a = turn
///
/// Fitted by iterated least squares to the objects that agree within 0.25 m, starting from the
/// motion before, or from that of the two objects with which most others agree. Measured where at
/// least three agree, interpolated elsewhere, then averaged over five frames. Traffic that moves as
/// one block is taken for the world, so look at the share that was measured.
/// @param camera_x_m the camera ahead of the rear axle.
/// @return one motion per frame, 0..last; empty where no two frames have three objects that agree.
std::vector<KittiMotion> KittiMotionFromLabels(const std::vector<KittiLabel>& labels,
                                               const KittiCamera& camera, double camera_x_m);

}  // namespace v2vouch::sim
