// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "daemon/common/base/time.h"

namespace v2vouch::sim {

struct AnnotationRequest {
  std::string log;
  std::string camera;       ///< Name; "" = the first of the vehicle.
  std::string config_path;  ///< Vehicle file; "" = what the log's V2VOUCH_CONFIG says.
  int every = 1;            ///< Each so many frames one picture.
  int at_most = 0;          ///< Spread evenly over the log instead; 0: as `every` says.
};

struct AnnotationResult {
  std::int64_t frames = 0;    ///< Of the camera in the log.
  std::int64_t pictures = 0;  ///< Handed out.
  std::int64_t unread = 0;    ///< Frames whose picture could not be read; drawn on an empty road.
  bool has_images = false;    ///< False: the log has boxes only.
  bool has_other_lists = false;  ///< Lists of another version of track_list_t: not drawn.
  bool has_lists = false;  ///< False: no TRACKS_LOCAL and no TRACKS_PRIORITY, so no track is drawn.
  std::int64_t damaged = 0;     ///< Stretches of the log.
  bool is_bad_request = false;  ///< The vehicle file or the camera's name is wrong, not the log.
};

/// Takes a picture; false stops.
using PictureSink = std::function<bool(Timestamp stamp, const cv::Mat& picture)>;

/// Hands out the camera's frames with boxes and tracks drawn in (drawing.h). A frame is a picture
/// (CAMERA_<NAME>_IMAGE), or a message of boxes where there are no pictures; its tracks are those
/// of the first lists valid at its time or up to 0.3 s later, in their last revision.
/// @return false with `error` set: log unreadable, no such camera, no frame of it.
bool AnnotateLog(const AnnotationRequest& request, const PictureSink& sink,
                 AnnotationResult& result, std::string& error);

}  // namespace v2vouch::sim
