// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <new>
#include <vector>

#include "daemon/common/base/random.h"
#include "daemon/v2v/intake/intake.h"
#include "tests/daemon/v2v/intake/talking_car.h"

namespace {
std::atomic<std::size_t> allocations{0};
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace v2vouch {
namespace {

double MicrosPerMessage(BsmIntake& intake, const std::vector<Bsm>& messages) {
  const EgoPlace ego = EgoAtCrossroads();
  const auto start = std::chrono::steady_clock::now();
  for (const Bsm& bsm : messages) {
    intake.Expire(bsm.stamp);
    (void)intake.Accept(bsm, ego);
  }
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
  return took.count() / static_cast<double>(messages.size());
}

// 5000 messages a second, each of an id and place of its own, for 10 s, and one honest car.
TEST(Flood, RandomIdentitiesNeitherGrowMemoryNorSilenceTheHonestCar) {
  BsmIntake intake{IntakeConfig{}};
  TalkingCar honest;
  ASSERT_EQ(WhyNot(intake.Accept(honest.Say(), EgoAtCrossroads())), kTaken);
  intake.Pin(honest.id, true);
  Random random(1);
  std::vector<Bsm> flood;
  for (int i = 0; i < 50'000; ++i) {
    TalkingCar ghost;
    ghost.id = static_cast<SenderId>(random.Bits());
    ghost.time_s = 0.0002 * i;
    ghost.east_m = random.Uniform(-900.0, 900.0);
    ghost.north_m = random.Uniform(-400.0, 400.0);
    flood.push_back(ghost.Say());
  }
  const std::size_t before = allocations;
  const EgoPlace ego = EgoAtCrossroads();
  std::size_t most = 0;
  int honest_taken = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < flood.size(); ++i) {
    intake.Expire(flood[i].stamp);
    (void)intake.Accept(flood[i], ego);
    if (i % 500 == 499) {
      honest.Drive(0.1);
      honest_taken += intake.Accept(honest.Say(), ego) ? 1 : 0;
    }
    most = std::max(most, intake.senders().size());
  }
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(allocations, before);
  EXPECT_LE(most, 2048U);
  EXPECT_EQ(honest_taken, 100);
  EXPECT_NE(intake.Find(honest.id), nullptr);
  std::cout << "flood of new identities: " << took.count() / static_cast<double>(flood.size())
            << " us per message, at most " << most << " senders\n";
}

// Amid them, a car that was never heard before.
TEST(Flood, RandomIdentitiesDoNotKeepANewcomerOut) {
  BsmIntake intake{IntakeConfig{}};
  Random random(3);
  const EgoPlace ego = EgoAtCrossroads();
  std::vector<TalkingCar> newcomers(20);
  std::vector<double> waited_s(newcomers.size(), 100.0);
  for (int i = 0; i < 40'000; ++i) {
    TalkingCar ghost;
    ghost.id = static_cast<SenderId>(random.Bits());
    ghost.time_s = 0.0002 * i;
    ghost.east_m = random.Uniform(-900.0, 900.0);
    ghost.north_m = random.Uniform(-400.0, 400.0);
    intake.Expire(ghost.Say().stamp);
    (void)intake.Accept(ghost.Say(), ego);
    // One newcomer every 0.2 s from 3 s on, each at 10 Hz.
    for (std::size_t k = 0; k < newcomers.size(); ++k) {
      const int since = i - 15'000 - 1000 * static_cast<int>(k);
      if (since < 0 || since % 500 != 0) continue;
      TalkingCar& car = newcomers[k];
      car.id = static_cast<SenderId>(77 + k);
      car.north_m = 20.0 + 10.0 * static_cast<double>(k);
      car.time_s = ghost.time_s - 0.1;
      car.Drive(0.1);
      const bool is_taken{intake.Accept(car.Say(), ego)};
      if (is_taken) waited_s[k] = std::min(waited_s[k], 0.0002 * since);
    }
  }
  for (const double waited : waited_s) EXPECT_LE(waited, 0.35);
}

// 1000 senders at 10 Hz: the design load, in the steady state.
TEST(Flood, AThousandSendersCostNoAllocation) {
  BsmIntake intake{IntakeConfig{.max_new_senders_per_s = 2000}};
  std::vector<TalkingCar> cars(1000);
  Random random(2);
  for (std::size_t i = 0; i < cars.size(); ++i) {
    cars[i].id = static_cast<SenderId>(random.Bits());
    cars[i].east_m = random.Uniform(-700.0, 700.0);
    cars[i].north_m = random.Uniform(-400.0, 400.0);
    cars[i].yaw_rad = random.Uniform(-kPi, kPi);
    cars[i].time_s = 1e-4 * static_cast<double>(i);
  }
  const auto second = [&cars] {
    std::vector<Bsm> messages;
    for (int round = 0; round < 10; ++round) {
      for (TalkingCar& car : cars) {
        car.Drive(0.1);
        messages.push_back(car.Say());
      }
    }
    return messages;
  };
  MicrosPerMessage(intake, second());
  const std::vector<Bsm> messages = second();
  const std::size_t before = allocations;
  const double micros = MicrosPerMessage(intake, messages);
  EXPECT_EQ(allocations, before);
  EXPECT_EQ(intake.senders().size(), 1000U);
  std::cout << "1000 senders at 10 Hz: " << micros << " us per message\n";
}

}  // namespace
}  // namespace v2vouch
