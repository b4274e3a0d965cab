// SPDX-License-Identifier: Apache-2.0
#include "sim/app/import_kitti.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "daemon/io/event_log.h"
#include "sim/app/picture_files.h"

namespace v2vouch::sim {
namespace {

constexpr int kFailed = 1;

int Fail(const std::string& why) {
  std::fprintf(stderr, "v2vouch-import: %s\n", why.c_str());
  return kFailed;
}

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

int WriteLog(const KittiRequest& request, const std::vector<ImportedEvent>& events,
             nlohmann::ordered_json figures) {
  std::string error;
  const auto writer = LogWriter::Create(request.out, error);
  if (writer == nullptr) return Fail(error);
  std::map<std::string, std::int64_t> channels;
  for (const ImportedEvent& event : events) {
    writer->Write(event.received, event.channel, event.bytes);
    ++channels[event.channel];
  }
  if (!writer->Close(error)) return Fail(error);
  figures["events"] = events.size();
  figures["seconds"] = ToSeconds(events.back().received - events.front().received);
  figures["channels"] = channels;
  if (request.as_json) {
    std::printf("%s\n", figures.dump().c_str());
    return 0;
  }
  for (const auto& [name, value] : figures.items()) {
    std::printf("%-16s %s\n", name.c_str(), value.dump().c_str());
  }
  return 0;
}

}  // namespace

int ImportKitti(const KittiRequest& given) {
  KittiRequest request = given;
  std::string error;
  std::vector<KittiLabel> labels;
  KittiCamera camera;
  if (request.labels.empty() && request.images.empty()) {
    return Fail("kitti wants --labels, --images or both");
  }
  if (!ReadKittiCamera(request.calibration, camera, error)) return Fail(error);
  if (!request.labels.empty() && !ReadKittiLabels(request.labels, labels, error)) {
    return Fail(error);
  }
  KittiPictures pictures;
  int count = 0;
  if (!request.images.empty()) {
    KittiOptions& options = request.options;
    const int last = LastNumberedPicture(request.images);
    if (last < 0 || !SizeOfNumberedPicture(request.images, last, options.image_width_px,
                                           options.image_height_px)) {
      return Fail(request.images + ": holds no numbered picture (000000.png ...)");
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
  if (motion.empty()) return Fail(error);
  const std::string name =
      "kitti " + std::filesystem::path(request.labels.empty() ? request.images : request.labels)
                     .stem()
                     .string();
  const auto events = KittiEvents(name, labels, camera, motion, request.options, pictures);
  if (!error.empty()) return Fail(error);
  const auto measured = std::count_if(motion.begin(), motion.end(),
                                      [](const KittiMotion& m) { return m.is_measured; });
  return WriteLog(
      request, events,
      {{"log", request.out},
       {"frames", motion.size()},
       {"pictures", count},
       {"ego_from", source},
       {"ego_measured", static_cast<double>(measured) / static_cast<double>(motion.size())}});
}

}  // namespace v2vouch::sim
