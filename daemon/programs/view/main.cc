// SPDX-License-Identifier: Apache-2.0
// v2vouch-view: the live page and Foxglove's protocol on one loopback port; plays logs too.
#include <arpa/inet.h>
#include <spawn.h>
#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>

#include "daemon/programs/view/live_source.h"
#include "daemon/programs/view/log_player.h"
#include "daemon/programs/view/server.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/program/command_line.h"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX wants it declared.

namespace {

using std::chrono::steady_clock;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-view --open                       # what v2vouchd publishes now
  v2vouch-view drive.lcm --open             # a recorded drive; space plays and pauses
  v2vouch-view --config vehicle.yaml -l 'udpm://239.255.76.67:7667?ttl=0'

Prints two addresses: the page, and the one for Foxglove or Lichtblick (Open connection, Foxglove
WebSocket). Both hold a token; without it nobody sees anything. Read-only: nothing that a client
sends reaches the car. A log of inputs alone has no lists: run v2vouch-replay over it first.

Exit codes: 0 stopped; 1 the log could not be read or the port not be opened; 2 usage or
configuration.)";

struct Options {
  std::string log;
  std::string config;
  std::string lcm_url;
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8790;
  bool wants_browser = false;
  bool has_no_token = false;
  double idle_timeout_s = 0.0;
  v2vouch::view::AccessRules rules;
};

/// The bus as the page names it: without options.
std::string BusName(const std::string& url) {
  const std::string name = v2vouch::EffectiveLcmUrl(url);
  return name.empty() ? "LCM's default bus" : name.substr(0, name.find('?'));
}

std::string CheckAddress(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> parsed{};
  for (const int family : {AF_INET, AF_INET6}) {
    if (inet_pton(family, text.c_str(), parsed.data()) == 1) return {};
  }
  return text + ": must be an IPv4 or IPv6 address of this machine";
}

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("LOG", options.log, "LCM log to play; without: live from LCM");
  app.add_option("--config", options.config, "Vehicle description (default: the shipped vehicle)");
  app.add_option("-l,--lcm-url", options.lcm_url, "LCM URL (default: the configuration's)")
      ->check(v2vouch::CheckLcmUrl);
  app.add_option("--port", options.port, "TCP port, 0 = any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--bind", options.bind, "Address to listen on; other than loopback needs a token")
      ->check(CheckAddress)
      ->capture_default_str();
  app.add_flag("--open", options.wants_browser, "Open the page in the browser (xdg-open)");
  app.add_flag("--no-token", options.has_no_token, "Let every program of this machine look");
  app.add_option("--allow-host", options.rules.hosts, "Further host name of this server");
  app.add_option("--allow-origin", options.rules.origins,
                 "Web origin that may connect, e.g. https://app.foxglove.dev");
  app.add_option("--idle-timeout", options.idle_timeout_s,
                 "End after so many seconds without a client; 0 = never");
}

std::string NewToken() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

bool ShowProgress(double share) {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  if (is_terminal) std::fprintf(stderr, "\rreading the log %3.0f %%", 100.0 * share);
  return !v2vouch::IsStopAsked();
}

void OpenBrowser(std::string url) {
  std::string program = "xdg-open";
  std::array<char*, 3> arguments = {program.data(), url.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) != 0) {
    std::cerr << "v2vouch-view: no xdg-open here; open the address yourself\n";
  }
}

int Run(const Options& options, const v2vouch::DaemonConfig& config) {
  using namespace v2vouch;
  view::Scene scene(config.perception.vehicle, config.lcm.channels);
  std::unique_ptr<LogPlayer> player;
  std::unique_ptr<LiveSource> live;
  std::string error;
  if (!options.log.empty()) {
    player = LogPlayer::Open(options.log, scene, ShowProgress, error);
    if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
    if (!player) {
      std::cerr << "v2vouch-view: " << error << '\n';
      return kExitFailed;
    }
    if (!player->has_lists()) {
      std::cerr
          << "v2vouch-view: note: the log holds neither TRACKS_LOCAL nor TRACKS_PRIORITY; run "
             "v2vouch-replay over it first\n";
    }
    NoteDamage("v2vouch-view", options.log, player->damaged());
  } else {
    const std::string url = options.lcm_url.empty() ? config.lcm.url : options.lcm_url;
    live = std::make_unique<LiveSource>(url, scene.Channels());
  }
  view::Hub hub(scene, player.get(), NewToken());
  hub.source_name = options.log.empty()
                        ? BusName(options.lcm_url.empty() ? config.lcm.url : options.lcm_url)
                        : options.log;
  view::AccessRules rules = options.rules;
  if (!options.has_no_token) rules.token = NewToken();
  Server server(hub, rules);
  if (!server.Listen(options.bind, options.port, error)) {
    std::cerr << "v2vouch-view: " << error << '\n';
    return kExitFailed;
  }
  const std::string name =
      options.bind.find(':') != std::string::npos ? "[" + options.bind + "]" : options.bind;
  const std::string address = name + ":" + std::to_string(server.port()) + "/";
  const std::string page = "http://" + address + (rules.token.empty() ? "" : "#t=" + rules.token);
  std::cout << "page:     " << page << "\nfoxglove: ws://" << address
            << (rules.token.empty() ? "" : "?t=" + rules.token) << std::endl;
  if (options.wants_browser) OpenBrowser(page);

  std::vector<LiveSource::Message> messages;
  server.Every(std::chrono::milliseconds(10), [&] {
    if (player) return player->Advance(steady_clock::now());
    live->Drain(messages);
    for (const auto& message : messages) {
      scene.Take(message.channel, message.bytes, message.received);
    }
    hub.is_source_open = live->is_open();
  });
  server.Every(std::chrono::milliseconds(40), [&] {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    hub.Tick(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
    server.Wake();
    const bool is_idle = options.idle_timeout_s > 0.0 && server.idle_s() > options.idle_timeout_s;
    if (IsStopAsked() || is_idle) server.Stop();
  });
  server.Run();
  return kExitGood;
}

int ReadAndRun(int argc, char** argv) {
  Options options;
  CLI::App app("Shows what the daemon sees, live or from a log: a page and Foxglove's protocol.");
  app.footer(kExamples);
  AddOptions(app, options);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-view", argc, argv)) return *code;
  const bool is_loopback = options.bind.starts_with("127.") || options.bind == "::1";
  if (!is_loopback && options.has_no_token) {
    std::cerr << "v2vouch-view: --bind " << options.bind
              << " needs the token: leave out --no-token\n";
    return v2vouch::kExitUsage;
  }
  if (!is_loopback) options.rules.hosts.push_back(options.bind);
  v2vouch::DaemonConfig config;
  std::vector<std::string> problems;
  // A log says itself which vehicle it is of.
  const std::string stored =
      options.log.empty() || !options.config.empty() ? "" : v2vouch::ConfigIn(options.log);
  if (!stored.empty()) {  // Another version's may have other keys; what is known is taken.
    v2vouch::config::Parse(stored, options.log + " (V2VOUCH_CONFIG)", config, problems);
    for (const std::string& problem : problems) {
      std::cerr << "v2vouch-view: note: " << problem << '\n';
    }
  } else if (!v2vouch::LoadDaemonConfig(options.config, config, problems)) {
    for (const std::string& problem : problems) std::cerr << problem << '\n';
    return v2vouch::kExitUsage;
  }
  v2vouch::HandleStopSignals();
  return Run(options, config);
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-view");
  try {
    return ReadAndRun(argc, argv);
  } catch (const std::exception& error) {  // Out of memory, a log that vanished.
    std::fprintf(stderr, "v2vouch-view: %s\n", error.what());
    return v2vouch::kExitFailed;
  }
}
