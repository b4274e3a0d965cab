// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/senders/sender_table.h"

#include <gtest/gtest.h>

#include <set>

namespace v2vouch {
namespace {

constexpr SenderLimits kTwo{.most = 2, .turnover_hz = 40.0};

Timestamp At(double s) { return FromMicros(1'000'000'000) + FromSeconds(s); }

// A car that drives along x at 10 m/s, in lane `lane`.
struct Speaker {
  SenderId id = 0;
  double lane_m = 0.0;

  [[nodiscard]] Claim Says(double t_s) const {
    Claim claim;
    claim.sender = id;
    claim.received = claim.first_heard = At(t_s);
    return claim;
  }
  [[nodiscard]] ClaimInOdometry Here(double t_s) const {
    ClaimInOdometry here;
    here.sender = id;
    here.stamp = At(t_s);
    here.p_O = {10.0 * t_s, lane_m};
    here.speed_mps = 10.0;
    return here;
  }
};

struct Table {
  SenderTable table;
  std::set<SenderId> with_vehicle, with_track;

  SenderTable::Admission Admit(const Speaker& speaker, double t_s) {
    return table.Admit(speaker.Says(t_s), speaker.Here(t_s), kTwo, TombstoneConfig{},
                       [this](SenderId id) {
                         return with_vehicle.contains(id) ? SenderHolds::kVehicle
                                : with_track.contains(id) ? SenderHolds::kTrack
                                                          : SenderHolds::kNothing;
                       });
  }
  void Penalise(const Speaker& speaker, double t_s) {
    SenderRecord& record = *table.Find(speaker.id);
    record.last = speaker.Here(t_s);
    record.trust.OnFinding(At(t_s), {Check::kEmptyPlace, Verdict::kWithdraw, "log_ratio", -5, -4},
                           true);
    table.UpdateTombstone(record);
  }
};

TEST(SenderTable, GivesUpTheRecordThatLosesLeast) {
  Table t;
  t.Admit({1}, 0.0);
  t.Admit({2}, 0.1);
  t.with_track.insert(1);
  const auto admission = t.Admit({3}, 0.2);
  ASSERT_NE(admission.record, nullptr);
  EXPECT_EQ(admission.evicted, SenderId{2});
  EXPECT_NE(t.table.Find(1), nullptr);
}

TEST(SenderTable, NeverGivesUpASenderWithAVehicle) {
  Table t;
  t.Admit({1}, 0.0);
  t.Admit({2}, 0.0);
  t.with_vehicle = {1, 2};
  for (SenderId id = 3; id < 100; ++id) {
    EXPECT_EQ(t.Admit({id}, 0.1).record, nullptr) << id;
  }
  EXPECT_NE(t.table.Find(1), nullptr);
  EXPECT_NE(t.table.Find(2), nullptr);
}

TEST(SenderTable, NewcomersTakeRecordsNoFasterThanTheTurnover) {
  Table t;
  t.Admit({1}, 0.0);
  t.Admit({2}, 0.0);
  int admitted = 0;
  for (SenderId id = 10; id < 1010; ++id) {
    const double t_s = 1e-3 * (id - 10);
    if (t.Admit({id}, t_s).record != nullptr) ++admitted;
  }
  // 40 per second, and half a second's tokens saved up.
  EXPECT_LE(admitted, 61);
  EXPECT_GE(admitted, 50);
}

TEST(SenderTable, ANewIdentityInheritsThePenaltyOfTheOneThatItContinues) {
  Table t;
  const Speaker liar{1};
  t.Admit(liar, 0.0);
  t.Penalise(liar, 1.0);
  t.table.Remove(liar.id);
  const auto admission = t.Admit({7}, 1.2);
  ASSERT_NE(admission.record, nullptr);
  EXPECT_EQ(admission.record->trust.state(), TrustState::kSuspect);
}

TEST(SenderTable, APenaltyIsNotWashedOffWhereThereWasNoRoom) {
  Table t;
  const Speaker liar{1};
  t.Admit(liar, 0.0);
  t.Penalise(liar, 1.0);
  t.table.Remove(liar.id);
  // Two cars with vehicles far from the liar fill the table.
  t.Admit({2, 50.0}, 1.0);
  t.Admit({3, 60.0}, 1.0);
  t.with_vehicle = {2, 3};
  ASSERT_EQ(t.Admit({7}, 1.2).record, nullptr);
  t.table.Remove(3);
  const auto admission = t.Admit({7}, 1.3);
  ASSERT_NE(admission.record, nullptr);
  EXPECT_EQ(admission.record->trust.state(), TrustState::kSuspect);
}

TEST(SenderTable, DropsTheSilentButNotTheHolderOfAVehicle) {
  Table t;
  t.Admit({1}, 0.0);
  t.Admit({2}, 0.0);
  t.with_vehicle = {2};
  t.table.DropSilent(At(10.0), 5.0, [&](SenderId id) {
    return t.with_vehicle.contains(id) ? SenderHolds::kVehicle : SenderHolds::kNothing;
  });
  EXPECT_EQ(t.table.Find(1), nullptr);
  EXPECT_NE(t.table.Find(2), nullptr);
}

}  // namespace
}  // namespace v2vouch
