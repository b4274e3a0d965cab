// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/obu/own_output.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>

#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch::obu {
namespace {

constexpr int kLongestWait_ms = 20;  // The jitter of a message that no input wakes us for.
constexpr std::chrono::milliseconds kPause{200};

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::optional<OutputForm> FormOfName(const std::string& name) {
  if (name == "frame") return OutputForm::kFrame;
  if (name == "dot2") return OutputForm::kDot2;
  if (name == "rsu_text") return OutputForm::kRsuText;
  return std::nullopt;
}

// "192.168.88.40:1516"; nothing is looked up.
std::optional<sockaddr_in> AddressOf(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return std::nullopt;
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, failed] = std::from_chars(text.data() + colon + 1, end, port);
  if (failed != std::errc{} || rest != end || port < 1 || port > 65535) return std::nullopt;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, text.substr(0, colon).c_str(), &address.sin_addr) != 1) {
    return std::nullopt;
  }
  return address;
}

OwnSenderConfig SenderConfig(const OwnBsmConfig& config) {
  OwnSenderConfig sender;
  sender.vehicle = {.antenna_x_m = config.antenna_x_m,
                    .antenna_y_m = config.antenna_y_m,
                    .centre_x_m = config.centre_x_m,
                    .length_m = config.length_m,
                    .width_m = config.width_m,
                    .id_change_us = std::llround(config.id_change_s * 1e6)};
  sender.form = FormOfName(config.form).value_or(OutputForm::kRsuText);
  sender.text = {
      .signs = config.unit_signs, .channel = config.radio_channel, .priority = config.priority};
  sender.rate_hz = config.rate_hz;
  return sender;
}

// Pseudonyms must not be guessed from those of another start.
std::uint64_t Seed() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

}  // namespace

void CheckOwnBsm(const OwnBsmConfig& config, std::vector<std::string>& problems) {
  if (!FormOfName(config.form)) {
    problems.push_back("own_bsm.form = " + config.form + ": must be rsu_text, frame or dot2");
  }
  if (const std::string problem = CheckLcmUrl(config.lcm_url); !problem.empty()) {
    problems.push_back("own_bsm.lcm_url: " + problem);
  }
  if (config.send_to.empty()) return;
  if (!AddressOf(config.send_to)) {
    problems.push_back("own_bsm.send_to = " + config.send_to +
                       ": must be an IPv4 address and a port, e.g. 192.168.88.40:1516");
  }
  if (!config.unit_sends_none) {
    problems.push_back(
        "own_bsm.send_to: needs own_bsm.unit_sends_none: true. A unit with a BSM stack of its own "
        "sends already, and two streams from one car contradict each other: turn the unit's off");
  }
}

std::unique_ptr<OwnOutput> OwnOutput::Start(const GatewayConfig& config, Log log,
                                            std::string& error) {
  if (config.own_bsm.send_to.empty() || !config.own_bsm.unit_sends_none) return nullptr;
  const auto address = AddressOf(config.own_bsm.send_to);
  const int udp = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (!address || udp < 0 ||
      connect(udp, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
    error = "cannot send to " + config.own_bsm.send_to + ": " + std::strerror(errno);
    if (udp >= 0) close(udp);
    return nullptr;
  }
  log("event=own_bsm_armed to=" + config.own_bsm.send_to + " form=" + config.own_bsm.form);
  return std::unique_ptr<OwnOutput>(new OwnOutput(config, std::move(log), udp));
}

OwnOutput::OwnOutput(const GatewayConfig& config, Log log, int socket)
    : config_(config.own_bsm),
      out_url_(config.lcm_url),
      log_(std::move(log)),
      socket_(socket),
      sender_(SenderConfig(config.own_bsm), Seed()),
      thread_([this] { Run(); }) {}

OwnOutput::~OwnOutput() {
  must_stop_ = true;
  thread_.join();
  close(socket_);
}

void OwnOutput::OnUnitSent(std::uint32_t id, std::int64_t utime) {
  const std::lock_guard lock(mutex_);
  sender_.OnUnitSent(id, utime);
}

OwnOutput::Figures OwnOutput::figures() const {
  const std::lock_guard lock(mutex_);
  return {sender_.state(), sender_.id(), sender_.sent(), failures_};
}

// There may be no way to a bus yet while a machine boots.
bool OwnOutput::Open() {
  if (!out_) out_ = LcmBus::Open(out_url_);
  if (in_ || !out_) return in_ != nullptr;
  auto in = LcmBus::Open(config_.lcm_url.empty() ? out_url_ : config_.lcm_url);
  if (!in) return false;
  const bool hears_motion = in->Subscribe(
      config_.motion_channel, [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
        const auto motion = wire::Decode<ego_motion_t>(bytes);
        const std::lock_guard lock(mutex_);
        if (motion) sender_.OnMotion(*motion);
      });
  const bool hears_fix = in->Subscribe(
      config_.fix_channel, [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
        const auto fix = wire::Decode<gnss_fix_t>(bytes);
        const std::lock_guard lock(mutex_);
        if (fix) sender_.OnFix(*fix);
      });
  if (hears_motion && hears_fix) in_ = std::move(in);
  return in_ != nullptr;
}

void OwnOutput::Step() {
  std::optional<OwnSender::Message> message;
  OwnState state = OwnState::kOff;
  {
    const std::lock_guard lock(mutex_);
    message = sender_.Step(Now());
    state = sender_.state();
  }
  if (state != told_) log_("event=own_bsm state=" + std::string(OwnStateName(state)));
  told_ = state;
  if (!message) return;
  // The daemon first: it must know the id before the echo comes.
  wire::Encode(message->bsm, bytes_);
  bool is_good = out_->Publish(config_.own_bsm_channel, bytes_);
  is_good = send(socket_, message->datagram.data(), message->datagram.size(), 0) >= 0 && is_good;
  if (is_good) return;
  const std::lock_guard lock(mutex_);
  ++failures_;
}

void OwnOutput::Run() {
  while (!must_stop_ && !Open()) std::this_thread::sleep_for(kPause);
  while (!must_stop_) {
    std::int64_t wait_us = 0;
    {
      const std::lock_guard lock(mutex_);
      wait_us = sender_.due() - Now();
    }
    const auto wait_ms =
        static_cast<int>(std::clamp<std::int64_t>((wait_us + 999) / 1000, 0, kLongestWait_ms));
    if (!in_->Handle(wait_ms)) std::this_thread::sleep_for(kPause);
    Step();
  }
}

}  // namespace v2vouch::obu
