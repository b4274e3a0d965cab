// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/claim.h"
#include "daemon/common/data/track.h"
#include "daemon/v2v/association/association_config.h"

namespace v2vouch {

/// The priority list as the paper builds it, kept so that reports can show its method beside ours:
/// every pair of Algorithm 1 is a priority track, fused by inverse covariance, and lives on the
/// sender's BSMs once its LOCAL track is gone. Two senders near one car give two tracks; a
/// sender that claims the position of a car is validated at once. Copyable; bounded.
class PaperList {
 public:
  struct Entry {
    std::uint64_t id = 0;
    SenderId sender = 0;
    std::uint64_t local_id = 0;  ///< 0: the LOCAL track is gone, BSMs keep it.
    LocalTrack track;            ///< Fused; valid at `stamp`.
    Timestamp stamp{};
    Timestamp last_v2v{};
  };

  /// One accepted claim in O; replaces the sender's last one.
  void OnClaim(const ClaimInOdometry& claim, const PaperConfig& config);
  /// One frame: Algorithm 1 over all confirmed LOCAL tracks and all live claims.
  void OnFrame(Timestamp stamp, std::span<const LocalTrack> tracks, const PaperConfig& config);
  /// Ordered by id.
  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }

 private:
  static constexpr std::size_t kMaxClaims = 64;
  std::vector<ClaimInOdometry> claims_;  // By sender.
  std::vector<Entry> entries_;
};

}  // namespace v2vouch
