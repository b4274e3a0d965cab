// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/warnings/assess.h"

namespace v2vouch::warnings {

/// The lists in, warnings out. Reads no clock: the same messages in the same order give the same
/// warnings, bit for bit. Copyable.
class Warner {
 public:
  Warner(const WarningsConfig& config, const EgoBody& body) : config_(config), body_(body) {}

  /// The yaw rate is smoothed over 0.2 s, or every sample's noise would bend the path ahead; a
  /// change beyond its noise is followed at once.
  void OnEgo(const EgoReading& ego);
  void OnIntent(const EgoIntent& intent) { intent_ = intent; }
  /// PRIORITY follows LOCAL at once, so warnings are made when it comes. Where no PRIORITY is
  /// heard any more, LOCAL makes them.
  std::optional<WarningList> OnLocal(const TargetList& list);
  std::optional<WarningList> OnPriority(const TargetList& list);

  /// When nothing comes any more: everything unavailable, the time of the last list.
  WarningList Silence();

 private:
  static constexpr std::size_t kLevels = 3;  // ADVISE, WARN, URGENT

  struct Entry {
    Warning shown;
    std::array<Timestamp, kLevels> true_since{};
    std::array<Timestamp, kLevels> last_true{};
    std::array<int, kLevels> lists{};
    Timestamp raised{};
    Timestamp lost_until{};
    bool is_present = false;  // Assessed in this step.
    bool is_listed = false;   // Its vehicle is in a list in this step.
    bool is_shown = false;
  };

  // Speeds of one vehicle over the last `sudden_s`.
  struct Past {
    std::int64_t track_id = 0;
    std::int64_t local_id = 0;
    Timestamp first{};
    std::vector<std::pair<Timestamp, double>> speeds{};
  };

  WarningList Make();
  void StartAnew(const TargetList& newest);
  void Follow(const Target& target, const Scene& scene);
  static void Join(const Entry& other, Entry& entry);
  void EndEntries(Timestamp now);
  void NoteSpeeds(std::vector<Target>& targets, Timestamp now);
  void Take(const std::vector<Assessment>& found, Timestamp now);
  void Advance(Entry& entry, Level level, Timestamp now);
  void EndOrHold(Entry& entry, Timestamp now);
  Entry& EntryOf(const Warning& warning, Timestamp now);
  [[nodiscard]] std::int32_t Availability(const TargetList& newest, std::int32_t& degraded) const;

  WarningsConfig config_;
  EgoBody body_;
  std::optional<EgoReading> ego_;
  std::optional<EgoIntent> intent_;
  std::optional<TargetList> local_;
  std::optional<TargetList> priority_;
  std::optional<Timestamp> waits_since_;  // Last PRIORITY; before it the first LOCAL.
  Timestamp last_fresh_{};                // Newest list that is no predicted copy.
  Timestamp last_now_{};
  std::int64_t seq_ = 0;
  std::vector<Entry> entries_;
  std::vector<Past> pasts_;
};

}  // namespace v2vouch::warnings
