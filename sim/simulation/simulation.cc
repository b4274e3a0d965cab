// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <v2vouch/text_t.hpp>

#include "daemon/rim/wire/codec.h"
#include "sim/attacks/attack_engine.h"
#include "sim/sensors/bsm.h"
#include "sim/sensors/camera.h"
#include "sim/sensors/ego.h"
#include "sim/sensors/message.h"
#include "sim/sensors/objects.h"
#include "sim/sensors/radar.h"
#include "sim/sensors/subject.h"
#include "sim/sensors/truth.h"
#include "sim/simulation/arrival_queue.h"

namespace v2vouch::sim {
namespace {

constexpr double kSlice_s = 1.0;
constexpr double kTruthPeriod_s = 0.05;

// Sources of one kind start a little apart, as free-running sensors do.
double Phase(std::size_t index, double offset_s, double period_s) {
  return std::fmod(offset_s + 0.0131 * static_cast<double>(index), period_s);
}

std::string ChannelOf(const RadarConfig& radar) { return "RADAR_" + radar.name; }
std::string ChannelOf(const CameraConfig& camera) {
  const bool is_detector = camera.source == CameraSource::kDetected;
  return "CAMERA_" + camera.name + (is_detector ? "_DETECTED" : "");
}
std::string ChannelOf(const ObjectSensorConfig& source) { return "OBJECTS_" + source.name; }

}  // namespace

struct Simulation::State {
  // Measurement times of a periodic source: k * period + phase, k = 0, 1, ...
  struct Ticks {
    double period_s = 0.1;
    double phase_s = 0.0;
    std::int64_t next = 0;

    [[nodiscard]] double time_s() const { return static_cast<double>(next) * period_s + phase_s; }
  };

  template <class Simulator, class Config, class WireType>
  struct Source {
    using Message = WireType;
    Simulator simulator;
    const Config& config;
    Ticks ticks;
  };

  State(const World& w, std::uint64_t s)
      : world(w),
        seed(s),
        odometry(w, s),
        gnss(w, s),
        truth(w, s),
        attacks(w, s),
        writer(w.scenario()) {
    const Scenario& scenario = w.scenario();
    start_utime = static_cast<std::int64_t>(scenario.start_utc_s) * 1000000;
    AddSources(w.vehicle().radars, 0.002, radars);
    AddSources(w.vehicle().cameras, 0.007, cameras);
    AddSources(w.vehicle().objects, 0.011, objects);
    odometry_ticks = {1.0 / scenario.odometry.rate_hz, 0.0};
    gnss_ticks = {1.0 / scenario.gnss.rate_hz, 0.0};
    truth_ticks = {kTruthPeriod_s, 0.0};
    for (std::size_t i = 0; i < w.actors().size(); ++i) {
      if (w.actors()[i].has_v2v) senders.emplace_back(w, static_cast<int>(i), s);
    }
    if (scenario.bsm.own_echo) senders.emplace_back(w, -1, s);
  }

  template <class Config, class Sensor>
  void AddSources(const std::vector<Config>& configs, double offset_s,
                  std::vector<Sensor>& sources) {
    for (std::size_t i = 0; i < configs.size(); ++i) {
      const Config& config = configs[i];
      sources.push_back({{world, static_cast<int>(i), seed},
                         config,
                         {config.period_s, Phase(i, offset_s, config.period_s)}});
    }
  }

  [[nodiscard]] std::int64_t Utime(double time_s) const {
    return start_utime + std::llround(time_s * 1e6);
  }

  template <class T>
  void Send(const std::string& channel, std::int64_t stamp_utime, double arrival_s,
            const T& message) {
    queue.Send(channel, stamp_utime, FromMicros(Utime(arrival_s)), message);
  }

  // Latency of one message: shortest, plus a uniform part, and now and then twice that.
  double Latency(const char* name, std::uint64_t index, std::int64_t seq, double shortest_s,
                 double spread_s) const {
    Random random = SubjectRandom(seed, name, {index, static_cast<std::uint64_t>(seq)});
    const double usual = shortest_s + spread_s * random.Uniform();
    return random.Bernoulli(0.01) ? usual + spread_s : usual;
  }

  bool IsFrameLost(const char* name, std::uint64_t index, std::int64_t seq) const {
    const double share = world.scenario().sensors.frame_loss;
    return share > 0.0 &&
           SubjectRandom(seed, name, {index, static_cast<std::uint64_t>(seq)}).Bernoulli(share);
  }

  struct Delays {
    const char* latency;  // Names of the random numbers.
    const char* frame;
    double shortest_s;
    double spread_s;
  };
  // Measures on all sensors of one kind: `measure(simulator, snapshot, seq, message)`.
  template <class Sensor, class Measure>
  void Run(std::vector<Sensor>& sources, double until_s, const Delays& delays,
           const Measure& measure) {
    typename Sensor::Message message{};
    for (std::size_t i = 0; i < sources.size(); ++i) {
      Sensor& source = sources[i];
      for (; source.ticks.time_s() < until_s; ++source.ticks.next) {
        const double time = source.ticks.time_s();
        measure(source.simulator, world.At(time), source.ticks.next, message);
        message.utime = Utime(time - source.config.clock_offset_s);
        const double latency =
            Latency(delays.latency, i, message.seq, delays.shortest_s, delays.spread_s);
        if (IsFrameLost(delays.frame, i, message.seq)) continue;
        Send(ChannelOf(source.config), message.utime, time + latency, message);
      }
    }
  }

  void RunSensors(double until_s);
  void RunEgo(double until_s);
  void RunTruth(double until_s);
  void RunSenders(double until_s);
  void Transmit(const Message& message);

  const World& world;
  std::uint64_t seed;
  std::int64_t start_utime = 0;
  double done_s = 0.0;
  std::vector<Source<RadarSimulator, RadarConfig, radar_scan_t>> radars;
  std::vector<Source<CameraSimulator, CameraConfig, camera_detections_t>> cameras;
  std::vector<Source<ObjectSimulator, ObjectSensorConfig, object_list_t>> objects;
  OdometrySimulator odometry;
  EgoGnssSimulator gnss;
  TruthWriter truth;
  Ticks odometry_ticks, gnss_ticks, truth_ticks;
  std::vector<BsmSender> senders;
  AttackEngine attacks;
  MessageWriter writer;
  ArrivalQueue queue;
};

// Radars, cameras and object lists: the same loop over sensors that measure other things.
void Simulation::State::RunSensors(double until_s) {
  const SensorsSpec& spec = world.scenario().sensors;
  Run(radars, until_s,
      {"radar latency", "radar frame", spec.radar_latency_s, spec.radar_latency_spread_s},
      [](RadarSimulator& simulator, const Snapshot& now, std::int64_t seq, radar_scan_t& scan) {
        simulator.Scan(now, seq, scan);
      });
  Run(cameras, until_s,
      {"camera latency", "camera frame", spec.camera_latency_s, spec.camera_latency_spread_s},
      [](CameraSimulator& simulator, const Snapshot& now, std::int64_t seq,
         camera_detections_t& picture) { simulator.Shoot(now, seq, picture); });
  Run(objects, until_s,
      {"objects latency", "objects frame", spec.objects_latency_s, spec.objects_latency_spread_s},
      [](ObjectSimulator& simulator, const Snapshot& now, std::int64_t seq, object_list_t& list) {
        simulator.Detect(now, seq, list);
      });
}

void Simulation::State::RunEgo(double until_s) {
  const Scenario& scenario = world.scenario();
  ego_motion_t motion{};
  for (; odometry_ticks.time_s() < until_s; ++odometry_ticks.next) {
    const double time = odometry_ticks.time_s();
    odometry.Measure(world.At(time), odometry_ticks.next, motion);
    motion.utime = Utime(time);
    Send("EGO_MOTION", motion.utime, time + scenario.odometry.latency_s, motion);
  }
  gnss_fix_t fix{};
  for (; gnss_ticks.time_s() < until_s; ++gnss_ticks.next) {
    const double time = gnss_ticks.time_s();
    gnss.Measure(world.At(time - scenario.vehicle.gnss_latency_s), gnss_ticks.next,
                 gnss_ticks.period_s, fix);
    fix.utime = Utime(time);
    Send("EGO_GNSS", fix.utime, time + scenario.gnss.latency_s, fix);
  }
}

void Simulation::State::RunTruth(double until_s) {
  truth_list_t list{};
  for (; truth_ticks.time_s() < until_s; ++truth_ticks.next) {
    const double time = truth_ticks.time_s();
    truth.Write(world.At(time), truth_ticks.next, list);
    list.utime = Utime(time);
    Send("TRUTH", list.utime, time, list);
  }
}

void Simulation::State::RunSenders(double until_s) {
  std::vector<Message> messages;
  for (BsmSender& sender : senders) {
    while (sender.next_time_s() < until_s) {
      std::optional<Message> message = sender.NextMessage();
      if (message) messages.push_back(std::move(*message));
    }
  }
  attacks.Apply(until_s, messages);
  for (const Message& message : messages) {
    if (!message.is_lost) Transmit(message);
  }
  std::vector<RawMessage> raw;
  attacks.AddFloods(until_s, raw);
  for (const RawMessage& message : raw) {
    queue.Pend(message.bsm, std::nullopt, message.is_cut);
  }
}

void Simulation::State::Transmit(const Message& message) {
  const bsm_t bsm = writer.Encode(message);
  queue.Pend(bsm, writer.Truth(message, bsm));
}

Simulation::Simulation(const World& world, std::uint64_t seed)
    : state_(std::make_unique<State>(world, seed)) {}

Simulation::~Simulation() = default;

bool Simulation::Step(std::vector<SimEvent>& events) {
  State& state = *state_;
  const double duration = state.world.scenario().duration_s;
  events.clear();
  if (state.done_s == 0.0) {
    text_t text{};
    text.utime = state.start_utime;
    text.name = state.world.scenario().name;
    text.text = ToYaml(state.world.scenario());
    SimEvent event{FromMicros(state.start_utime), "SIM_SCENARIO", {}};
    wire::Encode(text, event.bytes);
    events.push_back(std::move(event));
  }
  const double until = std::min(duration, state.done_s + kSlice_s);
  state.RunSensors(until);
  state.RunEgo(until);
  state.RunTruth(until);
  state.RunSenders(until);
  state.done_s = until;
  // Whatever is measured from now on arrives later than this. What is still under way when the
  // scenario ends never arrives.
  state.queue.Deliver(FromMicros(state.Utime(until)), events);
  return until < duration;
}

const std::vector<std::string>& Simulation::notes() const { return state_->attacks.notes(); }

double Simulation::progress() const { return state_->done_s / state_->world.scenario().duration_s; }

}  // namespace v2vouch::sim
