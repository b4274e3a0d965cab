// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/calibration_file/calibration_file.h"

#include <cstdint>
#include <span>
#include <string_view>

#include "daemon/common/base/sha256.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"
#include "daemon/rim/io/durable_file.h"

namespace v2vouch {
namespace {

constexpr std::string_view kHeader =
    R"header(# V2Vouch calibration of one car, made by v2vouch-calibrate; named by `calibration:` in the vehicle's
# configuration. Each value is in the unit its name ends with. std and prior_std are 1 sigma.
#
# Body frame: x forward, y left, z up; origin on the road below the middle of the rear axle.
#   radar_*.yaw_deg      of the antenna's axis, left positive: bearing = azimuth (left positive) + yaw
#   camera_*.yaw_deg     of the optical axis, left positive; pitch_deg down positive;
#                        roll_deg right side down positive
#   ego.antenna_*        the GNSS antenna
#   ego.heading_bias_deg     GNSS heading: measured = true + bias, counter-clockwise positive
#   ego.speed_scale          odometer: measured = scale x true
#   ego.yaw_rate_bias_degps  gyro: measured = true + bias, left positive
#   ego.odometer_y_m         where across the car its speed is measured; applied to nothing
#   ego.slip_s2pm            rear-axle slip k, v_y = -k v^2 w; applied to nothing
#
# verdict: ESTIMATED and WEAK values are used; PRIOR (the drive did not tell), AT_BOUND and REJECTED
# leave the configured value in force. covariance: row by row, rows as in `correlated`.
#
# The last line holds the SHA-256 of all lines above it. A file that was cut short or edited is
# refused; who edits it on purpose seals it again with
#   sed -i '$d' FILE && echo "checksum: $(sha256sum < FILE | cut -c-64)" >> FILE
)header";

constexpr std::string_view kChecksumKey = "checksum: ";
constexpr std::size_t kChecksumDigits = 64;

std::string ChecksumOf(std::string_view content) {
  Sha256 digest;
  digest.Add({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
  return digest.Hex();
}

// Takes the last line off. @return what it holds; nullopt where it is no checksum.
std::optional<std::string_view> TakeChecksum(std::string_view& text) {
  constexpr std::size_t kLine = kChecksumKey.size() + kChecksumDigits + 1;
  if (text.size() < kLine + 1 || text.back() != '\n') return std::nullopt;
  const std::string_view line = text.substr(text.size() - kLine, kLine - 1);
  if (!line.starts_with(kChecksumKey) || text[text.size() - kLine - 1] != '\n') return std::nullopt;
  text.remove_suffix(kLine);
  return line.substr(kChecksumKey.size());
}

}  // namespace

const char* VerdictName(CalibrationVerdict verdict) {
  switch (verdict) {
    case CalibrationVerdict::kEstimated:
      return "ESTIMATED";
    case CalibrationVerdict::kWeak:
      return "WEAK";
    case CalibrationVerdict::kPrior:
      return "PRIOR";
    case CalibrationVerdict::kAtBound:
      return "AT_BOUND";
    case CalibrationVerdict::kRejected:
      break;
  }
  return "REJECTED";
}

bool IsApplied(CalibrationVerdict verdict) {
  return verdict == CalibrationVerdict::kEstimated || verdict == CalibrationVerdict::kWeak;
}

bool SaveCalibration(const std::string& path, const CalibrationFile& calibration,
                     std::string& error, std::span<const std::string> inputs) {
  std::vector<std::string> problems;
  CheckCalibration(calibration, path, problems);
  if (!problems.empty()) {
    error = problems.front();
    return false;
  }
  std::string text(kHeader);
  text += config::Print(calibration);
  text += std::string(kChecksumKey) + ChecksumOf(text) + "\n";
  return ReplaceFile(path, text, error, inputs);
}

std::optional<CalibrationFile> LoadCalibration(const std::string& path,
                                               std::vector<std::string>& problems) {
  const auto text = config::ReadFile(path, problems);
  return text ? ParseCalibration(*text, path, problems) : std::nullopt;
}

std::optional<CalibrationFile> ParseCalibration(std::string_view text, const std::string& name,
                                                std::vector<std::string>& problems) {
  const auto refuse = [&](const std::string& what) {
    problems.push_back(name + ": " + what + "; make it again with v2vouch-calibrate");
    return std::nullopt;
  };
  if (text.empty()) return refuse("is empty");
  std::string_view content = text;
  const auto checksum = TakeChecksum(content);
  if (!checksum) return refuse("does not end in a checksum line: it was cut short or edited");
  const std::string actual = ChecksumOf(content);
  if (*checksum != actual) {
    return refuse("is not what was written (checksum " + actual.substr(0, 8) +
                  "..., its last line says otherwise): it was damaged, or edited without sealing "
                  "it again as its header says");
  }

  const std::size_t before = problems.size();
  CalibrationFile calibration;
  calibration.version = 0;  // Where the file does not say.
  config::Parse(content, name, calibration, problems);
  if (calibration.version == 1 && problems.size() > before) return std::nullopt;
  problems.resize(before);  // Of another version nothing else needs to be understood.
  CheckCalibration(calibration, name, problems);
  if (problems.size() > before) return std::nullopt;
  calibration.checksum = actual;
  return calibration;
}

}  // namespace v2vouch
