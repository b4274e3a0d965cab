// SPDX-License-Identifier: Apache-2.0
// Our receive path beside liblcm's, in one run: a child process publishes with liblcm, this one
// receives, in turn with each. Prints latency, loss and processor time per message; nothing is
// asserted. Inside a private network:
//   scripts/with_private_lcm build/release/bin/lcm_receive_benchmark [ROUNDS [SCALE]]
#include <lcm/lcm.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "daemon/rim/io/lcm_bus.h"

namespace {

using Clock = std::chrono::steady_clock;  // One clock for both processes.

struct Case {
  const char* name;
  std::size_t bytes;
  double rate_hz;  // 0: as fast as liblcm publishes.
  int count;
};

constexpr std::array<Case, 7> kCases = {{{"1 kB at 1000/s", 1000, 1000.0, 2000},
                                         {"1 kB at 10000/s", 1000, 10000.0, 20000},
                                         {"60 kB at 200/s", 60'000, 200.0, 400},
                                         {"60 kB at 1000/s", 60'000, 1000.0, 2000},
                                         {"1 MB at 30/s", 1'000'000, 30.0, 60},
                                         {"8 MB at 4/s", 8'000'000, 4.0, 10},
                                         {"1 kB flat out", 1000, 0.0, 100'000}}};

std::int64_t NowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

double ProcessorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// The child. Begins when told through the pipe, with the case's number.
[[noreturn]] void PublishAsTold(int orders, int answers, const char* url, double scale) {
  lcm_t* lcm = lcm_create(url);
  std::uint8_t number = 0;
  while (lcm != nullptr && read(orders, &number, 1) == 1 && number < kCases.size()) {
    const Case& each = kCases[number];
    std::vector<std::uint8_t> bytes(each.bytes, 7);
    const int count = std::max(2, static_cast<int>(each.count * scale));
    const auto start = Clock::now();
    for (int i = 0; i < count; ++i) {
      if (each.rate_hz > 0.0) {
        std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                                  std::chrono::duration<double>(i / each.rate_hz)));
      }
      const std::int64_t now_ns = NowNs();
      std::memcpy(bytes.data(), &now_ns, sizeof now_ns);
      lcm_publish(lcm, "BENCH", bytes.data(), static_cast<unsigned>(bytes.size()));
    }
    if (write(answers, &number, 1) != 1) break;
  }
  _exit(0);
}

struct Figures {
  double lost_percent = 0.0;
  double p50_us = 0.0;
  double p99_us = 0.0;
  double processor_us = 0.0;  // Per message received.
};

Figures RunOne(const std::string& url, std::uint8_t number, int orders, int answers, double scale) {
  const Case& each = kCases.at(number);
  const int sent = std::max(2, static_cast<int>(each.count * scale));
  std::vector<double> latencies_us;
  latencies_us.reserve(static_cast<std::size_t>(sent));
  const auto bus = v2vouch::LcmBus::Open(url);
  if (!bus || !bus->Subscribe("BENCH", [&](auto bytes, std::size_t, v2vouch::Timestamp) {
        std::int64_t then_ns = 0;
        if (bytes.size() == each.bytes) std::memcpy(&then_ns, bytes.data(), sizeof then_ns);
        latencies_us.push_back(1e-3 * static_cast<double>(NowNs() - then_ns));
      })) {
    std::fprintf(stderr, "lcm_receive_benchmark: %s cannot be opened\n", url.c_str());
    std::exit(1);
  }
  std::atomic<bool> is_over = false;
  const double before_s = ProcessorSeconds();
  std::thread draining([&] {
    while (!is_over) bus->Handle(20);
  });
  static_cast<void>(!write(orders, &number, 1));
  static_cast<void>(!read(answers, &number, 1));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  is_over = true;
  draining.join();
  Figures figures;
  const auto received = static_cast<double>(latencies_us.size());
  figures.processor_us = 1e6 * (ProcessorSeconds() - before_s) / std::max(1.0, received);
  figures.lost_percent = 100.0 * (1.0 - received / sent);
  if (latencies_us.empty()) return figures;
  std::ranges::sort(latencies_us);
  figures.p50_us = latencies_us[latencies_us.size() / 2];
  figures.p99_us = latencies_us[latencies_us.size() * 99 / 100];
  return figures;
}

Figures MedianOf(std::vector<Figures>& rounds) {
  const auto median = [&](double Figures::*field) {
    std::ranges::sort(rounds, {}, field);
    return rounds[rounds.size() / 2].*field;
  };
  return {median(&Figures::lost_percent), median(&Figures::p50_us), median(&Figures::p99_us),
          median(&Figures::processor_us)};
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  const double scale = argc > 2 ? std::atof(argv[2]) : 1.0;
  const char* const url = std::getenv("LCM_DEFAULT_URL");
  if (url == nullptr || rounds < 1) {
    std::fprintf(stderr, "lcm_receive_benchmark: run it through scripts/with_private_lcm\n");
    return 2;
  }
  int orders[2];
  int answers[2];
  if (pipe(orders) != 0 || pipe(answers) != 0) return 1;
  const pid_t child = fork();
  if (child == 0) {
    // With its own copy of the end that orders are written to it would wait for more for ever.
    close(orders[1]);
    close(answers[0]);
    PublishAsTold(orders[0], answers[1], url, scale);
  }
  if (child < 0) return 1;
  close(orders[0]);
  close(answers[1]);

  std::printf(
      "| messages | receiver | lost %% | p50 us | p99 us | processor us / message |\n"
      "|---|---|---|---|---|---|\n");
  for (std::uint8_t number = 0; number < kCases.size(); ++number) {
    std::array<std::vector<Figures>, 2> figures;
    for (int round = 0; round < 2 * rounds; ++round) {
      // In turn, and each first as often: what else the machine does meets both.
      const auto which = static_cast<std::size_t>(round % 2 != (round / 2) % 2);
      const std::string option = which == 0 ? "&receiver=liblcm" : "&receiver=own";
      figures.at(which).push_back(RunOne(url + option, number, orders[1], answers[0], scale));
    }
    for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
      const Figures all = MedianOf(figures.at(which));
      std::printf("| %s | %s | %.2f | %.0f | %.0f | %.1f |\n", kCases[number].name,
                  which == 0 ? "liblcm" : "own", all.lost_percent, all.p50_us, all.p99_us,
                  all.processor_us);
      std::fflush(stdout);
    }
  }
  close(orders[1]);
  waitpid(child, nullptr, 0);
  return 0;
}
