// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/annotate_log.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <utility>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/common/data/vehicle_section.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/channels.h"
#include "daemon/rim/wire/codec.h"
#include "sim/annotation/drawing.h"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/text_t.hpp"

namespace v2vouch::sim {
namespace {

constexpr std::int64_t kMaxListDelay_us = 300'000;

// Everything but the pictures, which stay in the file.
struct Contents {
  std::map<std::int64_t, camera_detections_t> boxes;
  std::map<std::int64_t, track_list_t> local;
  std::map<std::int64_t, track_list_t> priority;
  std::int64_t images = 0;
  bool has_other_lists = false;
};

template <class Message>
void Keep(const LogEvent& event, std::map<std::int64_t, Message>& kept) {
  if (auto message = wire::Decode<Message>(event.bytes)) {
    kept.insert_or_assign(message->utime, std::move(*message));
  }
}

// What is stale is a copy made while nothing came in.
void KeepList(const LogEvent& event, std::map<std::int64_t, track_list_t>& kept,
              bool& has_other_lists) {
  auto list = wire::Decode<track_list_t>(event.bytes);
  has_other_lists = has_other_lists || (!list && list.reason() == Reason::kWrongType);
  if (list && list->stale == 0) kept.insert_or_assign(list->utime, std::move(*list));
}

const track_list_t* ListAt(const std::map<std::int64_t, track_list_t>& lists, std::int64_t utime) {
  const auto found = lists.lower_bound(utime);
  return found == lists.end() || found->first - utime > kMaxListDelay_us ? nullptr : &found->second;
}

// Empty where the bytes are no picture of the camera's size.
cv::Mat PixelsOf(const camera_image_t& image, const CameraConfig& camera) {
  cv::Mat bgr;
  const auto pixels = static_cast<std::size_t>(camera.image_width_px) *
                      static_cast<std::size_t>(camera.image_height_px);
  const bool has_size =
      image.width_px == camera.image_width_px && image.height_px == camera.image_height_px;
  if (!has_size) return bgr;
  auto* const bytes = const_cast<std::uint8_t*>(image.data.data());  // NOLINT: only copied from.
  if (image.encoding == "jpeg") {
    try {
      bgr = cv::imdecode(image.data, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {
    }
  } else if (image.encoding == "mono8" && image.data.size() == pixels) {
    cv::cvtColor(cv::Mat(image.height_px, image.width_px, CV_8UC1, bytes), bgr, cv::COLOR_GRAY2BGR);
  } else if (image.encoding == "bgr8" && image.data.size() == 3 * pixels) {
    bgr = cv::Mat(image.height_px, image.width_px, CV_8UC3, bytes).clone();
  }
  const bool is_whole = bgr.cols == camera.image_width_px && bgr.rows == camera.image_height_px;
  return is_whole ? bgr : cv::Mat();
}

std::string Title(std::int64_t utime, std::int64_t first, const Scene& scene) {
  char text[128];
  std::snprintf(text, sizeof(text), "%.2f s   boxes %d   LOCAL %d (green)   PRIORITY %d (magenta)",
                static_cast<double>(utime - first) * 1e-6,
                scene.boxes != nullptr ? scene.boxes->num_boxes : 0,
                scene.local != nullptr ? scene.local->num_tracks : 0,
                scene.priority != nullptr ? scene.priority->num_tracks : 0);
  return text;
}

class Annotation {
 public:
  Annotation(const AnnotationRequest& request, AnnotationResult& result)
      : request_(request), result_(result) {}

  bool Run(const PictureSink& sink, std::string& error) {
    if (!ReadVehicle(error) || !ChooseCamera(error) || !ReadContents(error)) return false;
    result_.has_images = contents_.images > 0;
    result_.has_other_lists = contents_.has_other_lists;
    result_.has_lists = !contents_.local.empty() || !contents_.priority.empty();
    result_.frames =
        result_.has_images ? contents_.images : static_cast<std::int64_t>(contents_.boxes.size());
    if (result_.frames == 0) {
      error = request_.log + ": holds neither pictures nor boxes of camera " + camera_.name;
      if (!other_cameras_.empty()) {
        error += "; it holds " +
                 Listed(std::vector<std::string>(other_cameras_.begin(), other_cameras_.end()));
      }
      return false;
    }
    return result_.has_images ? OverImages(sink, error) : OverBoxes(sink);
  }

 private:
  bool ReadVehicle(std::string& error) {
    std::vector<std::string> problems;
    if (!request_.config_path.empty()) {
      const auto text = config::ReadFile(request_.config_path, problems);
      if (!text) {
        error = problems.empty() ? request_.config_path + ": cannot be read" : problems.front();
        result_.is_bad_request = true;
        return false;
      }
      if (ReadVehicleSection(*text, problems)) return true;
      result_.is_bad_request = true;
      error = problems.front();
      return false;
    }
    const auto reader = LogReader::Open(request_.log, error);
    if (!reader) return false;
    LogEvent event;
    while (reader->Next(event)) {
      if (event.channel != "V2VOUCH_CONFIG") continue;
      const auto message = wire::Decode<text_t>(event.bytes);
      if (!message) continue;
      config::Parse(message->text, "V2VOUCH_CONFIG", file_, problems);
      return true;
    }
    error = request_.log + ": holds no V2VOUCH_CONFIG; name the vehicle file by --config";
    return false;
  }

  // The file's other sections are other programs' business.
  bool ReadVehicleSection(const std::string& text, std::vector<std::string>& problems) {
    auto root = config::ParseYaml(text, request_.config_path, problems);
    if (!root) return false;
    for (std::size_t i = 0; i < root->keys.size(); ++i) {
      if (root->keys[i] != "vehicle") continue;
      config::YamlReader reader(root->items[i], "vehicle", request_.config_path, problems);
      file_.vehicle.Visit(reader);
      reader.Finish();
    }
    return problems.empty();
  }

  bool ChooseCamera(std::string& error) {
    std::vector<std::string> names;
    for (const CameraConfig& camera : file_.vehicle.cameras) names.push_back(camera.name);
    for (const CameraConfig& camera : file_.vehicle.cameras) {
      if (!request_.camera.empty() && camera.name != request_.camera) continue;
      camera_ = camera;
      return true;
    }
    error = names.empty() ? "the vehicle has no camera"
                          : "the vehicle has no camera " + request_.camera +
                                DidYouMean(request_.camera, names) + "; it has " + Listed(names);
    result_.is_bad_request = true;
    return false;
  }

  bool ReadContents(std::string& error) {
    const auto reader = LogReader::Open(request_.log, error);
    if (!reader) return false;
    const wire::ChannelNames names;
    const std::string channel = names.camera_prefix + camera_.name;
    LogEvent event;
    bool is_first = true;
    while (reader->Next(event)) {
      if (event.channel == channel + names.image_suffix) ++contents_.images;
      if (event.channel == channel || event.channel == channel + names.detected_suffix) {
        Keep(event, contents_.boxes);
      }
      if (event.channel.starts_with(names.camera_prefix)) other_cameras_.insert(event.channel);
      if (event.channel == names.tracks_local) {
        KeepList(event, contents_.local, contents_.has_other_lists);
      }
      if (event.channel == names.tracks_priority) {
        KeepList(event, contents_.priority, contents_.has_other_lists);
      }
      if (is_first) first_us_ = ToMicros(event.received);
      is_first = false;
    }
    result_.damaged = reader->damaged();
    return true;
  }

  [[nodiscard]] bool IsChosen(std::int64_t index) const {
    if (request_.at_most <= 0) return index % std::max(1, request_.every) == 0;
    // The first frame of each of `at_most` equal parts.
    const std::int64_t parts = std::min<std::int64_t>(request_.at_most, result_.frames);
    return index == 0 || index * parts / result_.frames != (index - 1) * parts / result_.frames;
  }

  bool Hand(std::int64_t utime, cv::Mat picture, const PictureSink& sink) {
    const auto boxes = contents_.boxes.find(utime);
    // A camera's clock offset is taken off before anything is tracked.
    const std::int64_t measured = utime + ToMicros(Timestamp(FromSeconds(camera_.clock_offset_s)));
    const Scene scene{boxes == contents_.boxes.end() ? nullptr : &boxes->second,
                      ListAt(contents_.local, measured), ListAt(contents_.priority, measured)};
    DrawScene(scene, camera_, Title(utime, first_us_, scene), picture);
    ++result_.pictures;
    return sink(FromMicros(utime), picture);
  }

  bool OverImages(const PictureSink& sink, std::string& error) {
    const auto reader = LogReader::Open(request_.log, error);
    if (!reader) return false;
    const wire::ChannelNames names;
    LogEvent event;
    std::int64_t index = 0;
    while (reader->Next(event)) {
      if (event.channel != names.camera_prefix + camera_.name + names.image_suffix) continue;
      if (!IsChosen(index++)) continue;
      const auto image = wire::Decode<camera_image_t>(event.bytes);
      cv::Mat picture = image ? PixelsOf(*image, camera_) : cv::Mat();
      if (picture.empty()) {
        ++result_.unread;
        picture = EmptyRoad(camera_);
      }
      const std::int64_t utime = image ? image->utime : ToMicros(event.received);
      if (!Hand(utime, picture, sink)) return true;
    }
    return true;
  }

  bool OverBoxes(const PictureSink& sink) {
    std::int64_t index = 0;
    for (const auto& [utime, boxes] : contents_.boxes) {
      if (IsChosen(index++) && !Hand(utime, EmptyRoad(camera_), sink)) break;
    }
    return true;
  }

  const AnnotationRequest& request_;
  AnnotationResult& result_;
  VehicleSection file_;
  CameraConfig camera_;
  Contents contents_;
  std::set<std::string> other_cameras_;  // Channels.
  std::int64_t first_us_ = 0;
};

}  // namespace

bool AnnotateLog(const AnnotationRequest& request, const PictureSink& sink,
                 AnnotationResult& result, std::string& error) {
  return Annotation(request, result).Run(sink, error);
}

}  // namespace v2vouch::sim
