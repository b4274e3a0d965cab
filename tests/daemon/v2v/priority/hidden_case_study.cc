// SPDX-License-Identifier: Apache-2.0
// Prints how well a validated vehicle is known through 4 s of hiding: the stated case and the
// harder ones (hidden_case.h).
//
//   build/release/bin/hidden_case_study [RUNS [SEED]]
#include <cstdio>
#include <cstdlib>

#include "tests/daemon/v2v/priority/hidden_case.h"

int main(int argc, char** argv) {
  using namespace v2vouch;
  const int runs = argc > 1 ? std::atoi(argv[1]) : 200;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 301;
  if (runs <= 0) {
    std::fprintf(stderr, "usage: hidden_case_study [RUNS [SEED]]\n");
    return 2;
  }
  struct Row {
    const char* name;
    HiddenCaseTarget target;
    double correlated_m;
  };
  constexpr Row kRows[] = {
      {"stated: extent known (point)", HiddenCaseTarget::kPoint, 0.0},
      {"correlated GNSS 0.5 m, 30 s", HiddenCaseTarget::kPoint, 0.5},
      {"reflections, extent known", HiddenCaseTarget::kExtentKnown, 0.0},
      {"reflections, extent unknown", HiddenCaseTarget::kExtentUnknown, 0.0},
      {"unknown and correlated", HiddenCaseTarget::kExtentUnknown, 0.5},
  };
  std::printf(
      "| %d runs | seen RMS [m] | ANEES | hidden RMS [m] | ANEES | after 4 s [m] | "
      "lost |\n|---|---|---|---|---|---|---|\n",
      runs);
  for (const Row& row : kRows) {
    const HiddenCaseResult r = RunHiddenCase(
        {.target = row.target, .runs = runs, .correlated_m = row.correlated_m, .seed = seed});
    std::printf("| %s | %.3f | %.2f | %.3f | %.2f | %.3f | %d |\n", row.name, r.seen.rms(),
                r.seen.anees(), r.hidden.rms(), r.hidden.anees(), r.at_end.rms(), r.lost);
  }
  return 0;
}
