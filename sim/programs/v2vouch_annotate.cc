// SPDX-License-Identifier: Apache-2.0
// v2vouch-annotate: a log's camera pictures with boxes and tracks drawn in.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "daemon/rim/io/durable_file.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/annotation/annotate_log.h"

namespace {

constexpr const char* kExamples = R"(Examples:
  v2vouch-annotate tracks.lcm pictures/
  v2vouch-annotate tracks.lcm pictures/ --camera FRONT --every 10

White: the camera's boxes. Green: LOCAL. Magenta: PRIORITY. LOG is what v2vouchd or v2vouch-replay
left, the pictures (CAMERA_*_IMAGE) in it; where there are none, boxes and tracks are drawn on an
empty road.

Exit codes: 0 good; 1 the log cannot be read, has no frame of the camera, or a picture cannot be
written, or none of its pictures can be read; 2 usage or vehicle file.)";

int Complain(const std::string& what, int code) {
  std::fprintf(stderr, "v2vouch-annotate: %s\n", what.c_str());
  return code;
}

int Run(const v2vouch::sim::AnnotationRequest& request, const std::string& folder, bool as_json) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    return Complain(folder + ": cannot be made: " + failed.message(), v2vouch::kExitFailed);
  const bool is_terminal = isatty(STDERR_FILENO) == 1;
  v2vouch::sim::AnnotationResult result;
  std::string error;
  const auto write = [&](v2vouch::Timestamp, const cv::Mat& picture) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06lld.png", static_cast<long long>(result.pictures - 1));
    const std::string path = (std::filesystem::path(folder) / name).string();
    std::vector<std::uint8_t> png;
    cv::imencode(".png", picture, png);
    v2vouch::ReplaceFile(path, {reinterpret_cast<const char*>(png.data()), png.size()}, error,
                         std::span(&request.log, 1));
    if (is_terminal)
      std::fprintf(stderr, "\r%lld pictures", static_cast<long long>(result.pictures));
    return error.empty();
  };
  const bool is_done = v2vouch::sim::AnnotateLog(request, write, result, error);
  if (is_terminal) std::fprintf(stderr, "\r\033[K");
  if (!is_done || !error.empty()) {
    return Complain(error, result.is_bad_request ? v2vouch::kExitUsage : v2vouch::kExitFailed);
  }
  v2vouch::NoteDamage("v2vouch-annotate", request.log, result.damaged);
  const nlohmann::ordered_json report = {{"frames", result.frames},
                                         {"pictures", result.pictures},
                                         {"unread", result.unread},
                                         {"has_images", result.has_images}};
  if (as_json) {
    std::printf("%s\n", report.dump().c_str());
  } else {
    std::printf("%lld pictures of %lld frames in %s\n", static_cast<long long>(result.pictures),
                static_cast<long long>(result.frames), folder.c_str());
  }
  if (result.has_images && result.unread == result.pictures) {
    return Complain(request.log +
                        ": none of the pictures could be read in the camera's size: "
                        "boxes and tracks are drawn on an empty road. Are image_width_px and "
                        "image_height_px those of the pictures?",
                    v2vouch::kExitFailed);
  }
  if (!result.has_images) {
    Complain("note: the log holds no pictures of this camera: boxes are drawn on an empty road", 0);
  }
  if (!result.has_lists && result.has_other_lists) {
    Complain(
        "note: the log's track lists are of another version of track_list_t (its fingerprint "
        "differs; CHANGELOG.md), so no tracks are drawn; v2vouch-replay makes them anew",
        0);
  } else if (!result.has_lists) {
    Complain(
        "note: the log holds no track lists, so no tracks are drawn; v2vouch-replay makes them", 0);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-annotate");
  v2vouch::sim::AnnotationRequest request;
  std::string folder;
  std::string lcm_url;
  bool as_json = false;
  CLI::App app("Draws boxes and tracks into the camera pictures of a log.", "v2vouch-annotate");
  app.footer(kExamples);
  app.add_option("LOG", request.log, "LCM log with tracks")->required();
  app.add_option("OUT_DIR", folder, "Folder for the pictures (made if absent)")->required();
  app.add_option("--camera", request.camera, "Name of the camera (default: the first)");
  app.add_option("--config", request.config_path, "Vehicle file (default: the log's own)");
  app.add_option("--every", request.every, "Each so many frames one picture")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--json", as_json, "Figures as one line of JSON");
  app.add_option("-l,--lcm-url", lcm_url, "Accepted for uniformity; logs need no network")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-annotate", argc, argv)) return *code;
  try {
    return Run(request, folder, as_json);
  } catch (const std::exception& error) {
    return Complain(error.what(), v2vouch::kExitFailed);
  }
}
