// SPDX-License-Identifier: Apache-2.0
#include "calibration/programs/drive_reader.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "daemon/common/base/sha256.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/input_decoder.h"

namespace v2vouch {
namespace {

bool HashFile(const std::string& path, std::string& hex) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (file == nullptr) return false;
  Sha256 sha;
  std::array<std::uint8_t, 1 << 16> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    sha.Add({buffer.data(), n});
  }
  hex = sha.Hex();
  return std::ferror(file.get()) == 0;
}

// Compared in floating point: a stamp may be anything.
bool IsAnotherTime(Timestamp a, Timestamp b) {
  constexpr double kStep_us = 600e6;
  return std::abs(static_cast<double>(ToMicros(a)) - static_cast<double>(ToMicros(b))) > kStep_us;
}

}  // namespace

bool ReadDrive(const std::vector<std::string>& logs, const DaemonConfig& config, Drive& drive,
               std::string& error, const std::function<void(double)>& progress) {
  const wire::InputDecoder decoder(config.perception.vehicle, config.lcm.channels);
  RefusalTally dropped;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const auto reader = LogReader::Open(logs[i], error);
    if (reader == nullptr) return false;
    std::optional<Timestamp> newest_motion;  // Of this log.
    LogEvent event;
    while (reader->Next(event)) {
      if (++drive.events % 4096 == 0 && progress) {
        progress((static_cast<double>(i) + reader->progress()) / static_cast<double>(logs.size()));
      }
      const auto channel = decoder.Find(event.channel);
      if (!channel || decoder.channels()[*channel].is_v2v()) continue;
      auto decoded = decoder.Decode(*channel, event.bytes, event.received, dropped);
      if (!decoded) {
        ++drive.refused;
      } else if (auto* input = std::get_if<Input>(&*decoded)) {
        const Timestamp stamp = HeaderOf(*input).stamp;
        const bool is_motion = std::holds_alternative<EgoMotion>(*input);
        if (newest_motion && IsAnotherTime(stamp, *newest_motion)) {
          if (!is_motion) {  // That sensor's clock is wrong; it measured nothing of this drive.
            ++drive.refused;
            continue;
          }
          error = logs[i] + ": the time of " + config.lcm.channels.ego_motion + " steps from " +
                  std::to_string(ToMicros(*newest_motion)) + " to " +
                  std::to_string(ToMicros(stamp)) +
                  " us within one log, more than 10 minutes: cut the log there, or mend its stamps";
          return false;
        }
        if (is_motion) newest_motion = stamp;
        drive.newest = std::max(drive.newest, stamp);
        drive.own.Keep(std::move(*input));
      }
    }
    drive.damaged += reader->damaged();
    if (!HashFile(logs[i], drive.log_sha256.emplace_back())) {
      error = logs[i] + ": cannot be read a second time";
      return false;
    }
  }
  drive.own.SortByStamp();
  if (drive.own.motion.empty()) {
    error = logs.front() + ": no " + config.lcm.channels.ego_motion + " of this vehicle in it";
    return false;
  }
  const auto& motion = drive.own.motion;
  constexpr Duration kLongestSpan = std::chrono::days(60);  // Every 5 s of it is a parameter.
  if (motion.back().stamp - motion.front().stamp > kLongestSpan) {
    error = "the logs lie more than 60 days apart: calibrate them one by one";
    return false;
  }
  return true;
}

}  // namespace v2vouch
