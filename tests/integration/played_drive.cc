// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/played_drive.h"

#include <chrono>
#include <thread>

#include "daemon/rim/engine/engine.h"
#include "tests/support/synthetic_drive.h"

namespace v2vouch::testing {

std::vector<WireMessage> DriveMessages(double duration_s) {
  SyntheticDrive drive;
  drive.duration_s = duration_s;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0, .sender = 0x11});
  return EncodeInputs(MakeInputs(drive), VehicleConfig{});
}

void Play(LcmBus& bus, const std::vector<WireMessage>& messages) {
  const auto start = std::chrono::steady_clock::now();
  for (const WireMessage& message : messages) {
    std::this_thread::sleep_until(start + (message.received - DriveStart()));
    bus.Publish(message.channel, message.bytes);
  }
}

std::string DigestOf(const std::vector<WireMessage>& messages) {
  Engine engine{DaemonConfig{}};
  Outbox outbox;
  for (const WireMessage& message : messages) {
    outbox.Clear();
    engine.OnMessage(message.channel, message.bytes, message.received, outbox);
  }
  return engine.digest_local();
}

}  // namespace v2vouch::testing
