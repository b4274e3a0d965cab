// SPDX-License-Identifier: Apache-2.0
// v2vouch-doctor: what is wrong with this set-up, and what to do about it.
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "daemon/programs/doctor/bus_check.h"
#include "daemon/programs/doctor/network_check.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

namespace {

using v2vouch::Advice;
using Clock = std::chrono::steady_clock;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-doctor --config /etc/v2vouch/vehicle.yaml
  v2vouch-doctor --config vehicle.yaml --seconds 10 --json

Looks at the network (route, interface, receive buffer, port, a message to itself), then listens: which
channel of the vehicle file is silent, what comes under a wrong name or type, whose clock is off, whether
v2vouchd runs, once. Changes nothing; sends on channel V2VOUCH_DOCTOR only.

Exit codes: 0 nothing bad (notes may stand), 1 something is wrong, 2 usage or configuration.)";

const char* Word(Advice::State state) {
  switch (state) {
    case Advice::State::kGood:
      return "good";
    case Advice::State::kNote:
      return "note";
    case Advice::State::kBad:
      return "bad";
  }
  return "";
}

// Every message of the buses until the time is over. @return how long that was.
std::chrono::duration<double> Listen(const std::vector<std::string>& urls, double seconds,
                                     v2vouch::BusCheck& check) {
  std::vector<std::unique_ptr<v2vouch::LcmBus>> buses;
  for (const std::string& url : urls) {
    auto bus = v2vouch::LcmBus::Open(url);
    if (bus &&
        bus->SubscribeAll(
            [&check](std::string_view channel, std::span<const std::uint8_t> bytes,
                     v2vouch::Timestamp received) { check.Hear(channel, bytes, received); })) {
      buses.push_back(std::move(bus));
    }
  }
  const auto start = Clock::now();
  while (!buses.empty() && Clock::now() - start < std::chrono::duration<double>(seconds) &&
         !v2vouch::IsStopAsked()) {
    for (const auto& bus : buses) bus->Handle(buses.size() == 1 ? 50 : 5);
  }
  return Clock::now() - start;
}

void Print(const v2vouch::AdviceList& findings, bool as_json, bool is_good) {
  if (as_json) {
    auto list = nlohmann::ordered_json::array();
    for (const Advice& each : findings) {
      list.push_back({{"check", each.check},
                      {"state", Word(each.state)},
                      {"text", each.text},
                      {"advice", each.advice}});
    }
    nlohmann::ordered_json all{{"good", is_good}, {"findings", list}};
    std::cout << all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    return;
  }
  for (const Advice& each : findings) {
    std::printf("%-4s  %-13s %s\n", Word(each.state), each.check.c_str(), each.text.c_str());
    if (!each.advice.empty()) std::printf("      %-13s   -> %s\n", "", each.advice.c_str());
  }
}

int Run(int argc, char** argv) {
  std::string config_path;
  std::string url;
  std::string v2v_url;
  double seconds = 3.0;
  bool wants_json = false;
  CLI::App app("Tells what is wrong with this set-up: network, channels, clocks, daemons.");
  app.footer(kExamples);
  app.add_option("--config", config_path, "Vehicle description (default: the shipped vehicle)");
  app.add_option("-l,--lcm-url", url, "LCM URL (default: as v2vouchd)")
      ->check(v2vouch::CheckLcmUrl);
  app.add_option("--v2v-lcm-url", v2v_url, "LCM URL of BSMs (default: as v2vouchd)")
      ->check(v2vouch::CheckLcmUrl);
  app.add_option("--seconds", seconds, "How long to listen")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 600.0));
  app.add_flag("--json", wants_json, "Print the findings as JSON");
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-doctor", argc, argv)) return *code;

  v2vouch::DaemonConfig config;
  std::vector<std::string> problems;
  v2vouch::LoadDaemonConfig(config_path, config, problems, nullptr);
  for (const std::string& problem : problems) std::cerr << problem << '\n';
  if (!problems.empty()) return v2vouch::kExitUsage;
  if (url.empty()) url = config.lcm.url;
  if (v2v_url.empty()) v2v_url = config.lcm.v2v_url;

  v2vouch::HandleStopSignals();
  v2vouch::AdviceList findings;
  std::vector<std::string> urls;
  if (v2vouch::CheckNetwork(url, "own sensors", findings)) urls.push_back(url);
  if (!v2v_url.empty() && v2vouch::CheckNetwork(v2v_url, "BSMs", findings)) urls.push_back(v2v_url);
  if (!v2v_url.empty() &&
      v2vouch::LcmUdpPort(v2vouch::EffectiveLcmUrl(url)) == v2vouch::LcmUdpPort(v2v_url)) {
    findings.push_back({Advice::State::kNote, "port",
                        "own sensors and BSMs share a port: a radio flood can cost radar",
                        "give lcm.v2v_url another port; another group separates nothing"});
  }
  if (!urls.empty()) {
    v2vouch::BusCheck check(config);
    const auto listened = Listen(urls, seconds, check);
    for (auto& each : check.Finish(listened)) findings.push_back(std::move(each));
  }
  const bool is_good = std::ranges::none_of(
      findings, [](const Advice& each) { return each.state == Advice::State::kBad; });
  Print(findings, wants_json, is_good);
  return is_good ? v2vouch::kExitGood : v2vouch::kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-doctor");
  try {
    return Run(argc, argv);
  } catch (const std::exception& error) {  // Out of memory, a disk that vanished.
    std::fprintf(stderr, "v2vouch-doctor: %s\n", error.what());
    return v2vouch::kExitFailed;
  }
}
