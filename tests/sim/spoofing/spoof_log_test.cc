// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <v2vouch/bsm_verdict_t.hpp>
#include <v2vouch/misbehavior_report_t.hpp>
#include <v2vouch/track_list_t.hpp>
#include <v2vouch/truth_bsm_t.hpp>
#include <v2vouch/truth_list_t.hpp>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "sim/run_log/run_log.h"

namespace v2vouch::evaluation {
namespace {

constexpr std::int64_t kTime_us = 1'781'510'400'000'000;
constexpr std::uint32_t kSender = 0x01020304;

template <class T>
void SetSender(T& message) {
  for (int i = 0; i < 4; ++i) message.sender_id[i] = static_cast<std::uint8_t>(i + 1);
}

class SpoofLog : public testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    const auto log = LogWriter::Create(path_, error);
    ASSERT_NE(log, nullptr) << error;
    truth_list_t scene{};
    scene.utime = kTime_us;
    Put(*log, "TRUTH", scene);
    truth_bsm_t truth{};
    truth.utime = kTime_us + 5;
    truth.seq = 42;
    SetSender(truth);
    truth.vehicle_id = 7;
    truth.device_id = 8;
    truth.is_attacker = truth.is_attack = 1;
    truth.age_s = 0.25;
    truth.claimed_x_m = 1.0;
    truth.claimed_y_m = 2.0;
    truth.claimed_speed_mps = -3.0;
    truth.claimed_width_m = 1.8;
    truth.honest_x_m = std::numeric_limits<double>::quiet_NaN();
    truth.honest_yaw_rad = 0.5;
    truth.honest_length_m = 4.5;
    Put(*log, "TRUTH_BSM", truth);
    bsm_verdict_t verdict{};
    verdict.utime = kTime_us + 5;
    verdict.seq = 42;
    SetSender(verdict);
    verdict.trust_state = 5;
    verdict.refusal = "bsm_rate";
    Put(*log, "BSM_VERDICT", verdict);
    misbehavior_report_t report{};
    SetSender(report);
    report.check = "level";
    report.verdict = misbehavior_report_t::ACCUSE;
    Put(*log, "MISBEHAVIOR", report);
    report.verdict = misbehavior_report_t::WITHDRAW;
    Put(*log, "MISBEHAVIOR", report);
    track_list_t list{};
    list.utime = kTime_us;
    for (const char* channel : {"TRACKS_LOCAL", "TRACKS_PRIORITY", "TRACKS_V2V"}) {
      Put(*log, channel, list);
    }
    ASSERT_TRUE(log->Close(error)) << error;
  }

  template <class T>
  void Put(LogWriter& log, const std::string& channel, const T& message) {
    std::vector<std::uint8_t> bytes;
    wire::Encode(message, bytes);
    log.Write(FromMicros(kTime_us), channel, bytes);
  }

  RunLog Read(ReadScope scope) {
    RunLog log;
    std::string error;
    EXPECT_TRUE(ReadRunLog(path_, {}, log, error, scope)) << error;
    return log;
  }

  std::string path_ = testing::TempDir() + "spoof_log_test.lcm";
};

TEST_F(SpoofLog, MessagesTruthsVerdictsAndReportsAreRead) {
  const RunLog log = Read(ReadScope::kSpoof);
  EXPECT_EQ(log.refused, 0);
  ASSERT_EQ(log.bsm_truths.size(), 1u);
  const BsmTruth& m = log.bsm_truths[0];
  EXPECT_EQ(ToMicros(m.stamp), kTime_us + 5);
  EXPECT_EQ(m.seq, 42);
  EXPECT_EQ(m.sender, kSender);
  EXPECT_EQ(m.vehicle, 7);
  EXPECT_EQ(m.device, 8);
  EXPECT_TRUE(m.is_attacker && m.is_attack);
  EXPECT_EQ(m.age_s, 0.25);
  EXPECT_EQ(m.claimed.p_W, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(m.claimed.speed_mps, -3.0);
  EXPECT_EQ(m.claimed.width_m, 1.8);
  EXPECT_TRUE(std::isnan(m.honest.p_W.x()));
  EXPECT_EQ(m.honest.yaw_rad, 0.5);
  EXPECT_EQ(m.honest.length_m, 4.5);
  ASSERT_EQ(log.bsm_verdicts.size(), 1u);
  EXPECT_EQ(log.bsm_verdicts[0].seq, 42);
  EXPECT_EQ(log.bsm_verdicts[0].trust, 5);
  EXPECT_EQ(log.bsm_verdicts[0].refusal, "bsm_rate");
  ASSERT_EQ(log.reports.size(), 2u);
  EXPECT_TRUE(log.reports[0].is_accusation);
  EXPECT_FALSE(log.reports[1].is_accusation);
}

TEST_F(SpoofLog, MessagesAreReadForSpoofingAlone) {
  const RunLog spoof = Read(ReadScope::kSpoof);
  EXPECT_EQ(spoof.lists[Index(ListKind::kLocal)].size(), 1u);
  EXPECT_FALSE(spoof.bsm_truths.empty());
  EXPECT_EQ(spoof.lists[Index(ListKind::kPriority)].size(), 1u);
  const RunLog all = Read(ReadScope::kAll);
  EXPECT_EQ(all.lists[Index(ListKind::kLocal)].size(), 1u);
  EXPECT_TRUE(all.bsm_truths.empty());
}

}  // namespace
}  // namespace v2vouch::evaluation
