// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/import_kitti.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "sim/programs/import_output.h"
#include "sim/programs/picture_files.h"

namespace v2vouch::sim {
namespace {

// Of every frame of the sequence, and where it comes from.
std::vector<KittiMotion> MotionOf(const KittiRequest& request,
                                  const std::vector<KittiLabel>& labels, const KittiCamera& camera,
                                  std::string& source, std::string& error) {
  int last = request.images.empty() ? 0 : LastNumberedPicture(request.images);
  for (const KittiLabel& label : labels) last = std::max(last, label.frame);
  const std::size_t frames = static_cast<std::size_t>(last) + 1;
  std::vector<KittiMotion> motion;
  if (!request.oxts.empty()) {
    source = "oxts";
    if (!ReadKittiOxts(request.oxts, motion, error)) return {};
  } else if (!labels.empty() && !request.ego_stands) {
    source = "labels";
    motion = KittiMotionFromLabels(labels, camera, request.options.camera_x_m);
    if (motion.empty()) {
      error = request.labels +
              ": no two frames have three objects that move alike, so the ego's motion cannot be "
              "found; give --oxts or --ego-stands";
    }
  } else {
    source = "given";
    motion.assign(1, {request.ego_speed_mps, 0.0, true});
  }
  if (!motion.empty()) motion.resize(frames, motion.back());
  return motion;
}

}  // namespace

int ImportKitti(const KittiRequest& given) {
  KittiRequest request = given;
  std::string error;
  std::vector<KittiLabel> labels;
  KittiCamera camera;
  if (request.labels.empty() && request.images.empty()) {
    return ImportFailed("kitti wants --labels, --images or both");
  }
  if (!ReadKittiCamera(request.calibration, camera, error)) return ImportFailed(error);
  if (!request.labels.empty() && !ReadKittiLabels(request.labels, labels, error)) {
    return ImportFailed(error);
  }
  if (!request.labels.empty() && labels.empty() && request.images.empty()) {
    return ImportFailed(request.labels +
                        ": holds no labelled object, so there is nothing to import");
  }
  KittiPictures pictures;
  int count = 0;
  if (!request.images.empty()) {
    KittiOptions& options = request.options;
    const int last = LastNumberedPicture(request.images);
    if (last < 0 || !SizeOfNumberedPicture(request.images, last, options.image_width_px,
                                           options.image_height_px)) {
      return ImportFailed(request.images + ": holds no numbered picture (000000.png ...)");
    }
    pictures = [&](int frame) {
      auto bytes = NumberedPicture(request.images, frame, options.image_width_px,
                                   options.image_height_px, error);
      if (!bytes.empty()) ++count;
      return bytes;
    };
  }
  std::string source;
  const auto motion = MotionOf(request, labels, camera, source, error);
  if (motion.empty()) return ImportFailed(error);
  const std::string name =
      "kitti " + std::filesystem::path(request.labels.empty() ? request.images : request.labels)
                     .stem()
                     .string();
  const auto events = KittiEvents(name, labels, camera, motion, request.options, pictures);
  if (!error.empty()) return ImportFailed(error);
  const auto measured = std::count_if(motion.begin(), motion.end(),
                                      [](const KittiMotion& m) { return m.is_measured; });
  return WriteImportedLog(
      request.out, std::array{request.labels, request.calibration, request.oxts}, events,
      {{"frames", motion.size()},
       {"pictures", count},
       {"ego_from", source},
       {"ego_measured", static_cast<double>(measured) / static_cast<double>(motion.size())}},
      request.as_json);
}

}  // namespace v2vouch::sim
