// SPDX-License-Identifier: Apache-2.0
// v2vouch-import: recordings of others -> LCM log or scenario.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/io/durable_file.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/import/comma2k19.h"
#include "sim/import/fcd.h"
#include "sim/import/sumo_scenario.h"
#include "sim/programs/import_kitti.h"
#include "sim/programs/import_output.h"

namespace v2vouch::sim {
namespace {

constexpr const char* kExamples = R"(Examples:
  v2vouch-import comma2k19 DRIVE --out drive.lcm
      DRIVE holds radar_tracks.csv, ego_speed.csv, imu_fwd_right_down.csv, gnss_ublox.csv.
      Then: v2vouch-replay drive.lcm --config daemon/vehicles/vehicle_comma2k19.yaml --out tracks.lcm
  v2vouch-import kitti --labels label_02/0001.txt --calib calib/0001.txt --out kitti.lcm
      KITTI tracking: labelled boxes with noise as a smart camera's. --images image_02/0001 puts the
      pictures in instead, for v2vouch-detect --log.
      Then: v2vouch-replay kitti.lcm --config daemon/vehicles/vehicle_kitti.yaml --out tracks.lcm
  v2vouch-import sumo-fcd fcd.csv.gz --ego auto --v2v-share 0.5 --out-scenario cologne
      Then: v2vouch-sim run cologne/scenario.yaml --seed 1 --out cologne.lcm

Exit codes: 0 good, 1 the recording cannot be read or the result not written, 2 usage.)";

// Progress for people; nothing when the output goes to a file.
void Say(const char* what) {
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "v2vouch-import: %s\n", what);
}

// What a folder lacks to be a drive of the collection; "" where nothing.
std::string WhyNoSegment(const std::string& folder) {
  std::error_code failed;
  if (!std::filesystem::is_directory(folder, failed)) return folder + ": is no folder";
  std::vector<std::string> there, missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    there.push_back(entry.path().filename().string());
  }
  std::sort(there.begin(), there.end());
  for (const char* name :
       {"radar_tracks.csv", "ego_speed.csv", "imu_fwd_right_down.csv", "gnss_ublox.csv"}) {
    if (std::find(there.begin(), there.end(), name) == there.end()) missing.emplace_back(name);
  }
  if (missing.empty()) return "";
  return folder + ": is no comma2k19 drive: it lacks " + Listed(missing) +
         (there.empty() ? " (it is empty)" : "; it holds " + Listed(there, 6));
}

int ImportComma2k19(const std::string& folder, const std::string& out,
                    const Comma2k19Options& options, bool as_json) {
  std::string error;
  Comma2k19Segment segment;
  if (const std::string why = WhyNoSegment(folder); !why.empty()) return ImportFailed(why);
  Say("reading the drive");
  if (!ReadComma2k19(folder, segment, error)) return ImportFailed(error);
  const std::vector<ImportedEvent> events = ToEvents(segment, options, error);
  if (events.empty()) return ImportFailed(folder + ": " + error);

  Say("writing the log");
  std::vector<std::string> inputs;
  std::error_code failed;
  for (const auto& file : std::filesystem::directory_iterator(folder, failed)) {
    inputs.push_back(file.path().string());
  }
  return WriteImportedLog(out, inputs, events, {}, as_json);
}

int ImportSumo(const std::string& path, const std::string& out, SumoOptions options, bool as_json) {
  std::string error;
  Say("reading the traffic");
  const std::vector<FcdVehicle> vehicles = ReadFcd(path, error);
  if (vehicles.empty()) return ImportFailed(error);

  const std::filesystem::path folder(out);
  if (options.name.empty()) options.name = folder.lexically_normal().filename().string();
  Say("choosing the ego and driving its surroundings");
  SumoScenario scenario;
  if (!MakeSumoScenario(vehicles, options, scenario, error)) {
    return ImportFailed(path + ": " + error);
  }

  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) return ImportFailed(out + ": cannot be made: " + failed.message());
  for (const auto& [name, text] : {std::pair{"scenario.yaml", &scenario.yaml},
                                   std::pair{"trajectories.csv", &scenario.trajectories_csv}}) {
    if (!ReplaceFile((folder / name).string(), *text, error, std::span(&path, 1))) {
      return ImportFailed(error);
    }
  }
  TellFigures({{"scenario", (folder / "scenario.yaml").string()},
               {"ego", scenario.ego},
               {"seconds", scenario.duration_s},
               {"vehicles", scenario.vehicles},
               {"buildings", scenario.buildings}},
              as_json);
  return 0;
}

struct Request {
  std::string in;
  std::string out;
  bool as_json = false;
};

CLI::App* AddComma2k19(CLI::App& app, Request& request, Comma2k19Options& drive,
                       double& latency_ms) {
  CLI::App* const comma =
      app.add_subcommand("comma2k19", "a real drive (radar objects, speed, gyro, GNSS) -> LCM log");
  comma->add_option("DIR", request.in, "folder of the segment's CSV files")->required();
  comma->add_option("--out", request.out, "log to write")->required();
  comma->add_option("--radar", drive.radar_name, "name of the radar in the vehicle file")
      ->capture_default_str();
  comma
      ->add_option(
          "--range-offset", drive.range_offset_m,
          "metres added to long_dist_m, which the collection counts from behind the sensor")
      ->capture_default_str();
  comma->add_flag("--flip-lateral", drive.flip_lateral, "lat_left_m is right positive");
  comma->add_option("--gnss-latency-ms", latency_ms, "from measurement to the receiver's output")
      ->check(CLI::Range(0.0, 2000.0))
      ->capture_default_str();
  comma->add_flag("--json", request.as_json, "figures as one line of JSON");
  return comma;
}

CLI::App* AddSumo(CLI::App& app, Request& request, SumoOptions& traffic, bool& no_buildings) {
  CLI::App* const sumo =
      app.add_subcommand("sumo-fcd", "SUMO floating car data (CSV, .gz too) -> scenario folder");
  sumo->add_option("FCD", request.in, "table with one row per vehicle and step")->required();
  sumo->add_option("--out-scenario", request.out,
                   "folder to write scenario.yaml and trajectories.csv to")
      ->required();
  sumo->add_option("--name", traffic.name, "of the scenario; default: the folder's");
  sumo->add_option("--ego", traffic.ego,
                   "SUMO id, or auto: the left-turner that meets most traffic")
      ->capture_default_str();
  sumo->add_option("--v2v-share", traffic.v2v_share, "share of vehicles that send BSMs")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  sumo->add_option("--van-share", traffic.van_share,
                   "share of cars made tall vans, which hide others")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  sumo->add_flag("--no-buildings", no_buildings, "no houses in the intersection's corners");
  sumo->add_option("--before", traffic.before_s, "seconds kept before the middle of the ego's turn")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  sumo->add_option("--after", traffic.after_s, "seconds kept after it")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  sumo->add_option("--seed", traffic.seed, "draws the vans")->capture_default_str();
  sumo->add_flag("--json", request.as_json, "figures as one line of JSON");
  return sumo;
}

CLI::App* AddKitti(CLI::App& app, KittiRequest& street) {
  CLI::App* const kitti =
      app.add_subcommand("kitti", "a KITTI tracking sequence (labels, pictures) -> LCM log");
  kitti->add_option("--labels", street.labels, "label file of the sequence (label_02)");
  kitti->add_option("--calib", street.calibration, "calibration file with P2")->required();
  kitti->add_option("--images", street.images, "folder of its pictures: no boxes, CAMERA_*_IMAGE");
  kitti->add_option("--oxts", street.oxts,
                    "oxts file: the ego's speed and yaw rate (default: from what stands still "
                    "among the labels)");
  kitti->add_flag("--ego-stands", street.ego_stands, "do not look for the ego's motion in labels");
  kitti->add_option("--ego-speed", street.ego_speed_mps, "m/s, where nothing tells it")
      ->check(CLI::Range(-20.0, 60.0))
      ->capture_default_str();
  kitti->add_option("--edge-sigma", street.options.edge_sigma_px, "noise of a box's edges, pixels")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  kitti
      ->add_option("--detection-probability", street.options.detection_probability,
                   "of a visible object, per frame")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  kitti->add_option("--clutter", street.options.clutter_per_image, "false boxes per frame")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  kitti->add_option("--seed", street.options.seed, "draws the noise")->capture_default_str();
  kitti->add_option("--out", street.out, "log to write")->required();
  kitti->add_flag("--json", street.as_json, "figures as one line of JSON");
  return kitti;
}

int Run(int argc, char** argv) {
  CLI::App app{"Turns recordings of others into LCM logs and scenarios.", "v2vouch-import"};
  app.footer(kExamples);
  app.require_subcommand(1);
  Request request;
  Comma2k19Options drive;
  double latency_ms = drive.gnss_latency_s * 1e3;
  const CLI::App* const comma = AddComma2k19(app, request, drive, latency_ms);
  SumoOptions traffic;
  traffic.name.clear();
  bool no_buildings = false;
  AddSumo(app, request, traffic, no_buildings);
  KittiRequest street;
  const CLI::App* const kitti = AddKitti(app, street);

  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-import", argc, argv)) return *code;
  drive.gnss_latency_s = latency_ms * 1e-3;
  traffic.has_buildings = !no_buildings;
  if (kitti->parsed()) return ImportKitti(street);
  return comma->parsed() ? ImportComma2k19(request.in, request.out, drive, request.as_json)
                         : ImportSumo(request.in, request.out, traffic, request.as_json);
}

}  // namespace
}  // namespace v2vouch::sim

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-import");
  try {
    return v2vouch::sim::Run(argc, argv);
  } catch (const std::exception& error) {  // Out of memory, a disk that vanished.
    std::fprintf(stderr, "v2vouch-import: %s\n", error.what());
    return v2vouch::kExitFailed;
  }
}
