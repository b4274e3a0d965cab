// SPDX-License-Identifier: Apache-2.0
#include "calibration/programs/remote_pairs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "daemon/pipeline/perception.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/input_decoder.h"

namespace v2vouch {
namespace {

constexpr double kEarth_m = 6'371'000.0;

// What a sender said of its motion, and where it was from the ego.
struct Said {
  Timestamp received{};
  Eigen::Vector2d velocity_en = Eigen::Vector2d::Zero();
  Eigen::Vector2d from_ego_en = Eigen::Vector2d::Zero();
};

// Perception as it runs without estimates, what it would have fed them noted down.
class Recorder final : public NullBiasEstimator {
 public:
  explicit Recorder(std::vector<BiasResidual>& residuals) : residuals_(residuals) {}
  void Observe(const BiasResidual& residual) override { residuals_.push_back(residual); }

 private:
  std::vector<BiasResidual>& residuals_;
};

// Small differences only: a sphere will do.
Eigen::Vector2d FromTo(const Wgs84& from, double latitude_rad, double longitude_rad) {
  return kEarth_m * Eigen::Vector2d(std::cos(from.latitude_rad) *
                                        std::remainder(longitude_rad - from.longitude_rad, 2 * kPi),
                                    latitude_rad - from.latitude_rad);
}

const Said* NearestTo(Timestamp t, const std::vector<Said>& said) {
  const auto after = std::ranges::lower_bound(said, t, {}, &Said::received);
  if (after != said.end()) return &*after;  // A claim is received after its time.
  return said.empty() ? nullptr : &said.back();
}

}  // namespace

bool CollectRemotePairs(const std::vector<std::string>& logs, const DaemonConfig& config,
                        std::vector<RemotePair>& pairs, std::string& error,
                        const std::function<void(double)>& progress) {
  const wire::InputDecoder decoder(config.perception.vehicle, config.lcm.channels);
  RefusalTally dropped;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const auto reader = LogReader::Open(logs[i], error);
    if (reader == nullptr) return false;
    std::vector<BiasResidual> residuals;
    Perception perception(config.perception, std::make_unique<Recorder>(residuals));
    std::map<SenderId, std::vector<Said>> said;
    std::optional<Wgs84> ego;
    Outputs outputs;
    LogEvent event;
    std::int64_t events = 0;
    while (reader->Next(event)) {
      if (++events % 4096 == 0 && progress) {
        progress((static_cast<double>(i) + reader->progress()) / static_cast<double>(logs.size()));
      }
      const auto channel = decoder.Find(event.channel);
      if (!channel) continue;
      const auto decoded = decoder.Decode(*channel, event.bytes, event.received, dropped);
      const Input* input = decoded ? std::get_if<Input>(&*decoded) : nullptr;
      if (input == nullptr) continue;
      perception.Step(*input, outputs);
      if (const auto* fix = std::get_if<GnssFix>(input)) ego = fix->position;
      const auto* bsm = std::get_if<Bsm>(input);
      if (bsm == nullptr || !ego || !bsm->latitude_rad || !bsm->longitude_rad) continue;
      const double speed = bsm->speed_mps.value_or(0.0);
      const double course = bsm->course_rad.value_or(0.0);
      said[bsm->sender].push_back({event.received,
                                   speed * Eigen::Vector2d(std::cos(course), std::sin(course)),
                                   FromTo(*ego, *bsm->latitude_rad, *bsm->longitude_rad)});
    }
    for (const BiasResidual& residual : residuals) {
      const Said* nearest = NearestTo(residual.stamp, said[residual.sender]);
      if (nearest == nullptr) continue;
      pairs.push_back(
          {.residual = residual,
           .velocity_en_mps = nearest->velocity_en,
           .range_m = nearest->from_ego_en.norm(),
           .bearing_rad = std::atan2(nearest->from_ego_en.y(), nearest->from_ego_en.x())});
    }
  }
  return true;
}

}  // namespace v2vouch
