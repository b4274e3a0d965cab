// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::campaign {

enum class Kind {
  kPlain,   ///< The scenario as it is: what attacked runs are compared with.
  kAttack,  ///< With an attack laid over it.
  kHonest,  ///< With an honest condition laid over it.
};

/// What is laid over a scenario. Catalogue files are named A05_lateral_8m.yaml: id "A5", variant
/// "lateral_8m". A file of the user's own has its name without ending as id.
struct Overlay {
  Kind kind = Kind::kPlain;
  std::string id;                    ///< "A5", "H1"; empty = plain.
  std::string variant;               ///< May be empty.
  std::string file;                  ///< Path of the YAML; empty = plain.
  bool sets_density = false;         ///< It states `traffic.vehicles` itself.
  std::vector<std::string> suits{};  ///< Names of the scenarios it is for; empty = all.

  [[nodiscard]] std::string name() const { return variant.empty() ? id : id + "/" + variant; }
  friend bool operator==(const Overlay&, const Overlay&) = default;
};

/// One simulated run.
struct Job {
  Overlay overlay;
  std::string scenario;  ///< Name of a shipped scenario, or a path.
  int density = 0;       ///< `traffic.vehicles`; 0 = the scenario's own.
  std::uint64_t seed = 1;

  /// Names the run in file names; distinct for distinct jobs: "A5-lateral_8m.urban.d20.s401".
  [[nodiscard]] std::string key() const;
  /// Name of the scenario without folder and ending.
  [[nodiscard]] std::string scenario_name() const;
};

/// What the files of a catalogue are, in order of letter, number and variant. Files whose names
/// say neither attack nor condition are left out.
std::vector<Overlay> ReadCatalogue(const std::vector<std::filesystem::path>& files);

/// The overlays meant by a comma-separated list of ids ("A5": all its variants; "A05" too),
/// variants ("A5/lateral_8m"), file names of the catalogue ("A05_lateral_8m"), paths of YAML files,
/// "all" or "none". Each once, in the order given.
/// @param kind kAttack or kHonest; what is named must be of it.
/// Names that mean nothing are told in `problems`.
std::vector<Overlay> Select(std::string_view list, Kind kind, const std::vector<Overlay>& catalogue,
                            std::vector<std::string>& problems);

struct Plan {
  std::vector<Overlay> overlays;
  std::vector<std::string> scenarios;
  std::vector<int> densities;
  std::uint64_t first_seed = 1;
  int seeds = 1;
  bool with_plain = true;  ///< Also the same runs without any overlay, where an attack is planned.
};

/// All runs of a plan. Seeds vary slowest, so that a campaign that is stopped has something of
/// everything. An overlay that sets the density itself runs once per seed and scenario, as density
/// 0.
std::vector<Job> Jobs(const Plan& plan);

/// Every n-th job from the (i-1)-th on: shards 1..n share out all jobs.
std::vector<Job> Shard(const std::vector<Job>& jobs, std::size_t i, std::size_t n);

}  // namespace v2vouch::campaign
