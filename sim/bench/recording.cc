// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/recording.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "daemon/common/base/angle.h"
#include "daemon/rim/io/output_file.h"
#include "sim/import/csv.h"

namespace v2vouch::bench {
namespace {

enum Column { kFrame, kTime, kKind, kId, kX, kY, kSpeed, kYaw, kYawRate };

// A sine this small is a quarter turn's rounding.
constexpr double kRounding = 1e-15;

double Snapped(double value) {
  const double nearest = std::round(value);
  return std::abs(value - nearest) < kRounding ? nearest : value;
}

bool IsInteger(double value) { return value == std::floor(value) && std::abs(value) < 1e9; }

// Puts the present row where it belongs, or marks it as faulty.
void Take(sim::CsvReader& csv, Recording& out) {
  const double frame = csv.Number(kFrame);
  const double time_s = csv.Number(kTime);
  const double id = csv.Number(kId);
  const VehiclePose pose{.id = 0,
                         .x_m = csv.Number(kX),
                         .y_m = csv.Number(kY),
                         .speed_mps = csv.Number(kSpeed),
                         .yaw_rad = csv.Number(kYaw),
                         .yaw_rate_radps = csv.Number(kYawRate)};
  if (!csv.error().empty()) return;
  if (!IsInteger(frame)) return csv.Fail("frame is not a whole number");
  if (!IsInteger(id)) return csv.Fail("id is not a whole number");
  if (std::abs(time_s) > 1e9) return csv.Fail("t lies beyond 1e9 s");
  const int number = static_cast<int>(frame);
  if (out.empty() || out.back().number != number) {
    if (!out.empty() && number < out.back().number) return csv.Fail("frame goes back");
    if (!out.empty() && time_s <= out.back().time_s) return csv.Fail("t does not rise");
    out.push_back({.number = number, .time_s = time_s, .truth = {}, .detections = {}});
  } else if (time_s != out.back().time_s) {
    return csv.Fail("t differs from that of the frame's first row");
  }
  const std::string_view kind = csv.Text(kKind);
  if (kind != "T" && kind != "D") return csv.Fail("kind is neither T nor D");
  auto& rows = kind == "T" ? out.back().truth : out.back().detections;
  rows.push_back(pose);
  rows.back().id = static_cast<int>(id);
}

}  // namespace

std::optional<Recording> ReadRecording(const std::string& path, std::string& error) {
  const auto csv = sim::CsvReader::Open(
      path, {"frame", "t", "kind", "id", "x", "y", "v", "yaw", "yaw_rate"}, error);
  if (csv == nullptr) return std::nullopt;
  Recording out;
  while (csv->Next()) Take(*csv, out);
  error = csv->error();
  if (error.empty() && out.empty()) error = path + ": has no frame";
  if (!error.empty()) return std::nullopt;
  return out;
}

bool WriteRecording(const Recording& recording, const std::string& path, std::string& error,
                    std::span<const std::string> inputs) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(OpenOutput(path, inputs, error),
                                                             &std::fclose);
  if (file == nullptr) return false;
  std::fputs("frame,t,kind,id,x,y,v,yaw,yaw_rate\n", file.get());
  for (const Frame& frame : recording) {
    const auto write = [&](char kind, const std::vector<VehiclePose>& rows) {
      for (const VehiclePose& p : rows) {
        std::fprintf(file.get(), "%d,%.3f,%c,%d,%.4f,%.4f,%.4f,%.5f,%.5f\n", frame.number,
                     frame.time_s, kind, p.id, p.x_m, p.y_m, p.speed_mps, p.yaw_rad,
                     p.yaw_rate_radps);
      }
    };
    write('T', frame.truth);
    write('D', frame.detections);
  }
  if (std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0) {
    error = path + ": cannot be written: " + std::strerror(errno);
    return false;
  }
  return true;
}

Recording Rotated(const Recording& recording, double angle_rad) {
  const double c = Snapped(std::cos(angle_rad));
  const double s = Snapped(std::sin(angle_rad));
  Recording out = recording;
  for (Frame& frame : out) {
    for (auto* rows : {&frame.truth, &frame.detections}) {
      for (VehiclePose& p : *rows) {
        const double x = p.x_m;
        p.x_m = c * x - s * p.y_m;
        p.y_m = s * x + c * p.y_m;
        p.yaw_rad = WrapAngle(p.yaw_rad + angle_rad);
      }
    }
  }
  return out;
}

}  // namespace v2vouch::bench
