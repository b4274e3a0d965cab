// SPDX-License-Identifier: Apache-2.0
// Vehicles round the car, from both lists. Usage: consume_lists [LCM_URL]; of a log:
// file://tracks.lcm?speed=0
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <v2vouch/track_list_t.hpp>

using v2vouch::sector_health_t;
using v2vouch::track_list_t;
using v2vouch::track_t;

struct Surroundings {  // PRIORITY where it speaks, LOCAL for the others.
  track_list_t local{}, priority{};
  std::int64_t printed_s = 0;

  void Take(const lcm::ReceiveBuffer*, const std::string& channel, const track_list_t* news) {
    track_list_t& kept = channel == "TRACKS_LOCAL" ? local : priority;
    // Reordered on the way: too late. More than a second back: the daemon has started anew. The
    // same utime once more is a correction by late data (revision counts up): it replaces the list.
    if (news->utime < kept.utime && kept.utime - news->utime < 1'000'000) return;
    kept = *news;
    if (news->utime / 1'000'000 != printed_s) Print(news->stale != 0);
    printed_s = news->utime / 1'000'000;
  }

  template <class Use>  // use(track, is_priority); a vehicle that is in both lists comes once.
  void ForEachVehicle(Use use) const {
    std::set<std::int64_t> rests_on;
    for (const track_t& t : priority.tracks) {  // SUSPECT and REVOKED: LOCAL's word alone.
      if (t.trust_state == track_t::TRUST_SUSPECT || t.trust_state == track_t::TRUST_REVOKED) {
        continue;
      }
      if (t.local_id != 0) rests_on.insert(t.local_id);  // 0: hidden now, kept by V2V.
      use(t, true);
    }
    for (const track_t& t : local.tracks) {
      if (rests_on.count(t.id) == 0) use(t, false);
    }
  }

  bool IsBlind(double azimuth_rad) const {  // Whether "no vehicle there" would mean nothing.
    const auto turn = [](double a) { return a - 2 * M_PI * std::floor(a / (2 * M_PI)); };
    for (const sector_health_t& s : local.sectors) {
      const bool is_inside = turn(azimuth_rad - s.from_rad) <= turn(s.to_rad - s.from_rad);
      if (is_inside && s.state != sector_health_t::BLIND) return false;
    }
    return true;
  }

  void Print(bool is_stale) const {
    const char* state = is_stale ? "stale: predicted, no frame for 100 ms" : "fresh";
    std::printf("%.2f %s, ahead %s\n", 1e-6 * static_cast<double>(local.utime), state,
                IsBlind(0.0) ? "BLIND" : "watched");
    ForEachVehicle([](const track_t& t, bool is_priority) {
      std::printf("  %-8s x %6.1f y %6.1f m %5.1f m/s%s\n", is_priority ? "PRIORITY" : "LOCAL",
                  t.x_body_m, t.y_body_m, t.speed_mps,
                  is_priority && t.local_id == 0 ? " hidden" : "");
    });
  }
};

int main(int argc, char** argv) {
  lcm::LCM bus(argc > 1 ? argv[1] : "");
  if (!bus.good()) return std::fprintf(stderr, "no LCM there: v2vouch-doctor tells more\n"), 1;
  Surroundings around;
  bus.subscribe("TRACKS_(LOCAL|PRIORITY)", &Surroundings::Take, &around);
  while (bus.handle() == 0) {
  }
}
