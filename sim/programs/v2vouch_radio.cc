// SPDX-License-Identifier: Apache-2.0
// v2vouch-radio: the air between simulated cars' on-board units, over UDP.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"
#include "daemon/rim/wire/codec.h"
#include "sim/radio/relay.h"

namespace v2vouch::sim {
namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouch-radio --car 0:0:127.0.0.1:5398 --car 1:6001 --car 2:6002
      what is sent to UDP 6001 is car 1's, to 6002 car 2's; the ego car's gateway (v2vouch-obu) hears
      both on 5398, as far as the air lets it
  v2vouch-radio --config radio.yaml --seed 7 --json
      ranges, bursts, delays and buildings from a file (docs/reference/on-board-units.md);
      figures on Ctrl-C

Where the cars are comes from TRUTH over LCM (v2vouch-sim run --live). Ports are opened on 127.0.0.1.
Exit codes: 0 good, 1 a socket or the LCM bus cannot be opened, 2 usage or configuration.)";

constexpr int kLongestWait_ms = 50;  // How soon a stop is noticed.

void Complain(const std::string& what) {
  std::fprintf(stderr, "v2vouch-radio: %s\n", what.c_str());
}

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::optional<sockaddr_in> AddressOf(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, failed] = std::from_chars(text.data() + colon + 1, end, port);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (failed != std::errc{} || rest != end || port < 1 || port > 65535 ||
      inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) != 1) {
    return std::nullopt;
  }
  return address;
}

// "ID:LISTEN" or "ID:LISTEN:ADDRESS:PORT".
std::optional<RadioCarSpec> CarOf(const std::string& text) {
  RadioCarSpec car;
  const std::size_t first = text.find(':');
  if (first == std::string::npos) return std::nullopt;
  const std::size_t second = std::min(text.find(':', first + 1), text.size());
  const auto number = [&](std::size_t from, std::size_t to, int& value) {
    const auto [rest, failed] = std::from_chars(text.data() + from, text.data() + to, value);
    return failed == std::errc{} && rest == text.data() + to && value >= 0;
  };
  if (!number(0, first, car.id) || !number(first + 1, second, car.listen)) return std::nullopt;
  if (second < text.size()) car.deliver = text.substr(second + 1);
  return car;
}

void Check(const RadioConfig& config, std::vector<std::string>& problems) {
  if (config.cars.size() < 2) problems.push_back("cars: at least two are needed");
  for (const RadioCarSpec& car : config.cars) {
    const std::string name = "cars: " + std::to_string(car.id);
    if (!car.deliver.empty() && !AddressOf(car.deliver)) {
      problems.push_back(name + ": deliver = " + car.deliver +
                         ": must be an IPv4 address and a port, e.g. 127.0.0.1:5398");
    }
    if (car.listen > 65535) problems.push_back(name + ": listen: at most 65535");
    if (std::ranges::count(config.cars, car.id, &RadioCarSpec::id) > 1) {
      problems.push_back(name + ": named twice");
    }
  }
}

class Air {
 public:
  Air(const RadioConfig& config, std::uint64_t seed) : config_(config), relay_(config, seed) {}
  ~Air() {
    must_stop_ = true;
    if (truth_.joinable()) truth_.join();
    for (const pollfd& wait : waits_) close(wait.fd);
    if (out_ >= 0) close(out_);
  }
  Air(const Air&) = delete;
  Air& operator=(const Air&) = delete;

  bool Open() {
    bus_ = LcmBus::Open(config_.lcm_url);
    if (!bus_ || !bus_->Subscribe(config_.truth_channel, [this](std::span<const std::uint8_t> bytes,
                                                                std::size_t, Timestamp) {
          const auto truth = wire::Decode<truth_list_t>(bytes);
          const std::lock_guard lock(mutex_);
          if (truth) relay_.OnTruth(*truth);
        })) {
      Complain("LCM bus '" + EffectiveLcmUrl(config_.lcm_url) + "' cannot be opened");
      return false;
    }
    out_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    for (std::size_t i = 0; i < config_.cars.size(); ++i) {
      const auto address = AddressOf("127.0.0.1:" + std::to_string(config_.cars[i].listen));
      if (config_.cars[i].listen == 0 || !address) continue;
      const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
      waits_.push_back({udp, POLLIN, 0});
      senders_.push_back(i);
      if (bind(udp, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
        Complain("UDP port " + std::to_string(config_.cars[i].listen) + ": " +
                 std::strerror(errno));
        return false;
      }
    }
    truth_ = std::thread([this] {
      while (!must_stop_) bus_->Handle(kLongestWait_ms);
    });
    std::fprintf(stderr, "v2vouch-radio: event=listening cars=%zu\n", config_.cars.size());
    return true;
  }

  void Run() {
    std::vector<std::uint8_t> buffer(65536);
    while (!IsStopAsked()) {
      std::int64_t wait_us = kLongestWait_ms * 1000;
      {
        const std::lock_guard lock(mutex_);
        if (const auto due = relay_.due())
          wait_us = std::clamp<std::int64_t>(*due - Now(), 0, wait_us);
      }
      const timespec wait{0, static_cast<long>(wait_us) * 1000};
      ppoll(waits_.data(), waits_.size(), &wait, nullptr);
      const std::lock_guard lock(mutex_);
      for (std::size_t i = 0; i < waits_.size(); ++i) {
        for (int taken = 0; taken < 64; ++taken) {
          const ssize_t size = recv(waits_[i].fd, buffer.data(), buffer.size(), 0);
          if (size < 0) break;
          relay_.OnDatagram(senders_[i], std::span(buffer).first(static_cast<std::size_t>(size)),
                            Now());
        }
      }
      while (const auto delivery = relay_.Next(Now())) {
        const auto to = AddressOf(config_.cars[delivery->car].deliver);
        sendto(out_, delivery->bytes.data(), delivery->bytes.size(), 0,
               reinterpret_cast<const sockaddr*>(&*to), sizeof *to);
      }
    }
  }

  [[nodiscard]] RadioFigures figures() const { return relay_.figures(); }

 private:
  RadioConfig config_;
  std::mutex mutex_;
  Relay relay_;
  std::unique_ptr<LcmBus> bus_;
  std::vector<pollfd> waits_;
  std::vector<std::size_t> senders_;  // Car of each socket.
  int out_ = -1;
  std::atomic<bool> must_stop_ = false;
  std::thread truth_;
};

void Print(const RadioFigures& figures, bool as_json) {
  const nlohmann::ordered_json json = {
      {"sent", figures.sent},       {"links", figures.links},
      {"heard", figures.heard},     {"too_far", figures.too_far},
      {"blocked", figures.blocked}, {"interference", figures.interference},
      {"copies", figures.copies},   {"nowhere", figures.nowhere}};
  if (as_json) {
    std::printf("%s\n", json.dump().c_str());
    return;
  }
  for (const auto& [name, count] : json.items()) {
    std::printf("%-14s %10lld\n", name.c_str(), static_cast<long long>(count.get<std::int64_t>()));
  }
}

}  // namespace
}  // namespace v2vouch::sim

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-radio");
  using namespace v2vouch::sim;
  std::string config_path, lcm_url;
  std::vector<std::string> cars;
  std::uint64_t seed = 1;
  bool as_json = false;
  CLI::App app("The air between simulated cars: loss, delay, copies and signal strength over UDP.");
  app.footer(kExamples);
  app.add_option("--config", config_path, "Cars, link and obstacles (YAML)");
  app.add_option("--car", cars, "ID:LISTEN[:ADDRESS:PORT]; 0 = the ego car; may be repeated");
  app.add_option("--seed", seed, "Seed of all random numbers")->capture_default_str();
  app.add_option("-l,--lcm-url", lcm_url, "Where TRUTH comes from")->check(v2vouch::CheckLcmUrl);
  app.add_flag("--json", as_json, "Figures as JSON at the end");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-radio", argc, argv)) return *code;

  RadioConfig config;
  std::vector<std::string> problems;
  if (!config_path.empty()) v2vouch::config::Load(config_path, config, problems);
  for (const std::string& text : cars) {
    if (const auto car = CarOf(text)) {
      config.cars.push_back(*car);
    } else {
      problems.push_back("--car " + text + ": must be ID:LISTEN or ID:LISTEN:ADDRESS:PORT");
    }
  }
  if (!lcm_url.empty()) config.lcm_url = lcm_url;
  if (problems.empty()) Check(config, problems);
  for (const std::string& problem : problems) Complain(problem);
  if (!problems.empty()) return v2vouch::kExitUsage;

  v2vouch::HandleStopSignals();
  Air air(config, seed);
  if (!air.Open()) return 1;
  air.Run();
  Print(air.figures(), as_json);
  return 0;
}
