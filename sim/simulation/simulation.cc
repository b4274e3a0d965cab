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

namespace v2vouch::sim {
namespace {

constexpr double kSlice_s = 1.0;
constexpr double kTruthPeriod_s = 0.05;

// Measurement times of a periodic source: k * period + phase, k = 0, 1, ...
struct Ticks {
  double period_s = 0.1;
  double phase_s = 0.0;
  std::int64_t next = 0;

  [[nodiscard]] double time_s() const { return static_cast<double>(next) * period_s + phase_s; }
};

// Sources of one kind start a little apart, as free-running sensors do.
double Phase(std::size_t index, double offset_s, double period_s) {
  return std::fmod(offset_s + 0.0131 * static_cast<double>(index), period_s);
}

}  // namespace

struct Simulation::State {
  struct Radar {
    RadarSimulator simulator;
    const RadarConfig& config;
    Ticks ticks;
  };
  struct Camera {
    CameraSimulator simulator;
    const CameraConfig& config;
    Ticks ticks;
  };
  struct Objects {
    ObjectSimulator simulator;
    const ObjectSensorConfig& config;
    Ticks ticks;
  };
  struct Pending {
    SimEvent event;
    std::int64_t stamp_utime = 0;
    std::optional<bsm_t> bsm;  // Numbered and encoded when its turn comes.
    std::optional<truth_bsm_t> truth;
    bool is_cut = false;  // Half of its bytes arrive.
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
    for (std::size_t i = 0; i < w.vehicle().radars.size(); ++i) {
      const RadarConfig& config = w.vehicle().radars[i];
      radars.push_back({RadarSimulator(w, static_cast<int>(i), s),
                        config,
                        {config.period_s, Phase(i, 0.002, config.period_s)}});
    }
    for (std::size_t i = 0; i < w.vehicle().cameras.size(); ++i) {
      const CameraConfig& config = w.vehicle().cameras[i];
      cameras.push_back({CameraSimulator(w, static_cast<int>(i), s),
                         config,
                         {config.period_s, Phase(i, 0.007, config.period_s)}});
    }
    for (std::size_t i = 0; i < w.vehicle().objects.size(); ++i) {
      const ObjectSensorConfig& config = w.vehicle().objects[i];
      objects.push_back({ObjectSimulator(w, static_cast<int>(i), s),
                         config,
                         {config.period_s, Phase(i, 0.011, config.period_s)}});
    }
    odometry_ticks = {1.0 / scenario.odometry.rate_hz, 0.0};
    gnss_ticks = {1.0 / scenario.gnss.rate_hz, 0.0};
    truth_ticks = {kTruthPeriod_s, 0.0};
    for (std::size_t i = 0; i < w.actors().size(); ++i) {
      if (w.actors()[i].has_v2v) senders.emplace_back(w, static_cast<int>(i), s);
    }
    if (scenario.bsm.own_echo) senders.emplace_back(w, -1, s);
  }

  [[nodiscard]] std::int64_t Utime(double time_s) const {
    return start_utime + std::llround(time_s * 1e6);
  }

  template <class T>
  void Send(const std::string& channel, std::int64_t stamp_utime, double arrival_s,
            const T& message) {
    Pending pending;
    pending.event.arrival = FromMicros(Utime(arrival_s));
    pending.event.channel = channel;
    pending.stamp_utime = stamp_utime;
    wire::Encode(message, pending.event.bytes);
    queue.push_back(std::move(pending));
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

  void RunRadars(double until_s);
  void RunCameras(double until_s);
  void RunObjects(double until_s);
  void RunEgo(double until_s);
  void RunTruth(double until_s);
  void RunSenders(double until_s);
  void Transmit(const Message& message);
  void Pend(const bsm_t& bsm);
  void Deliver(Timestamp before, std::vector<SimEvent>& events);

  const World& world;
  std::uint64_t seed;
  std::int64_t start_utime = 0;
  double done_s = 0.0;
  std::vector<Radar> radars;
  std::vector<Camera> cameras;
  std::vector<Objects> objects;
  OdometrySimulator odometry;
  EgoGnssSimulator gnss;
  TruthWriter truth;
  Ticks odometry_ticks, gnss_ticks, truth_ticks;
  std::vector<BsmSender> senders;
  AttackEngine attacks;
  MessageWriter writer;
  std::int64_t bsm_seq = 0;
  std::vector<Pending> queue;
};

void Simulation::State::RunRadars(double until_s) {
  const SensorsSpec& spec = world.scenario().sensors;
  radar_scan_t scan{};
  for (std::size_t i = 0; i < radars.size(); ++i) {
    Radar& radar = radars[i];
    for (; radar.ticks.time_s() < until_s; ++radar.ticks.next) {
      const double time = radar.ticks.time_s();
      radar.simulator.Scan(world.At(time), radar.ticks.next, scan);
      scan.utime = Utime(time - radar.config.clock_offset_s);
      const double latency =
          Latency("radar latency", i, scan.seq, spec.radar_latency_s, spec.radar_latency_spread_s);
      if (IsFrameLost("radar frame", i, scan.seq)) continue;
      Send("RADAR_" + radar.config.name, scan.utime, time + latency, scan);
    }
  }
}

void Simulation::State::RunCameras(double until_s) {
  const SensorsSpec& spec = world.scenario().sensors;
  camera_detections_t picture{};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    Camera& camera = cameras[i];
    const bool is_detector = camera.config.source == CameraSource::kDetected;
    const std::string channel = "CAMERA_" + camera.config.name + (is_detector ? "_DETECTED" : "");
    for (; camera.ticks.time_s() < until_s; ++camera.ticks.next) {
      const double time = camera.ticks.time_s();
      camera.simulator.Shoot(world.At(time), camera.ticks.next, picture);
      picture.utime = Utime(time - camera.config.clock_offset_s);
      const double latency = Latency("camera latency", i, picture.seq, spec.camera_latency_s,
                                     spec.camera_latency_spread_s);
      if (IsFrameLost("camera frame", i, picture.seq)) continue;
      Send(channel, picture.utime, time + latency, picture);
    }
  }
}

void Simulation::State::RunObjects(double until_s) {
  const SensorsSpec& spec = world.scenario().sensors;
  object_list_t list{};
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Objects& source = objects[i];
    for (; source.ticks.time_s() < until_s; ++source.ticks.next) {
      const double time = source.ticks.time_s();
      source.simulator.Detect(world.At(time), source.ticks.next, list);
      list.utime = Utime(time - source.config.clock_offset_s);
      const double latency = Latency("objects latency", i, list.seq, spec.objects_latency_s,
                                     spec.objects_latency_spread_s);
      if (IsFrameLost("objects frame", i, list.seq)) continue;
      Send("OBJECTS_" + source.config.name, list.utime, time + latency, list);
    }
  }
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
    Pend(message.bsm);
    queue.back().is_cut = message.is_cut;
  }
}

void Simulation::State::Transmit(const Message& message) {
  const bsm_t bsm = writer.Encode(message);
  Pend(bsm);
  queue.back().truth = writer.Truth(message, bsm);
}

void Simulation::State::Pend(const bsm_t& bsm) {
  Pending pending;
  pending.event.arrival = FromMicros(bsm.rx_utime);
  pending.event.channel = "BSM";
  pending.stamp_utime = bsm.generation_utime;
  pending.bsm = bsm;
  queue.push_back(std::move(pending));
}

void Simulation::State::Deliver(Timestamp before, std::vector<SimEvent>& events) {
  // Ties: by channel, then stamp; the sort is stable, so one sender's messages keep their order.
  std::stable_sort(queue.begin(), queue.end(), [](const Pending& a, const Pending& b) {
    if (a.event.arrival != b.event.arrival) return a.event.arrival < b.event.arrival;
    if (a.event.channel != b.event.channel) return a.event.channel < b.event.channel;
    return a.stamp_utime < b.stamp_utime;
  });
  std::size_t count = 0;
  for (; count < queue.size() && queue[count].event.arrival < before; ++count) {
    Pending& pending = queue[count];
    if (pending.bsm) {
      pending.bsm->seq = bsm_seq++;
      wire::Encode(*pending.bsm, pending.event.bytes);
      if (pending.is_cut) pending.event.bytes.resize(pending.event.bytes.size() / 2);
    }
    events.push_back(std::move(pending.event));
    if (pending.truth) {
      pending.truth->seq = bsm_seq - 1;
      SimEvent beside{events.back().arrival, "TRUTH_BSM", {}};
      wire::Encode(*pending.truth, beside.bytes);
      events.push_back(std::move(beside));
    }
  }
  queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(count));
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
  state.RunRadars(until);
  state.RunCameras(until);
  state.RunObjects(until);
  state.RunEgo(until);
  state.RunTruth(until);
  state.RunSenders(until);
  state.done_s = until;
  // Whatever is measured from now on arrives later than this. What is still under way when the
  // scenario ends never arrives.
  state.Deliver(FromMicros(state.Utime(until)), events);
  return until < duration;
}

const std::vector<std::string>& Simulation::notes() const { return state_->attacks.notes(); }

double Simulation::progress() const { return state_->done_s / state_->world.scenario().duration_s; }

}  // namespace v2vouch::sim
