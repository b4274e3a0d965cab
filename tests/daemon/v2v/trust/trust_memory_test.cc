// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/trust_memory.h"

#include <gtest/gtest.h>

namespace v2vouch {
namespace {

const Timestamp kStart = FromMicros(1'700'000'000'000'000);
const CertificateDigest kCertificate = {1, 2, 3};

TrustMemory Suspect(SenderId sender, double since_s) {
  return {.sender = sender,
          .certificate = kCertificate,
          .state = TrustState::kSuspect,
          .suspicions = 1,
          .since_s = since_s,
          .finding_s = since_s};
}

TEST(TrustMemory, IsHandedOutOnceWithItsAge) {
  RestoredTrust restored({Suspect(7, 10.0)});
  restored.OnEvent(kStart);
  restored.OnEvent(kStart + FromSeconds(3.0));
  EXPECT_FALSE(restored.TakeFor(8, {}, kStart));
  const auto memory = restored.TakeFor(7, {}, kStart + FromSeconds(5.0));
  ASSERT_TRUE(memory);
  EXPECT_DOUBLE_EQ(memory->since_s, 15.0);
  EXPECT_FALSE(restored.TakeFor(7, {}, kStart + FromSeconds(6.0)));
}

TEST(TrustMemory, ACertificateIsRecognisedUnderANewId) {
  RestoredTrust restored({Suspect(7, 10.0)});
  EXPECT_TRUE(restored.TakeFor(99, kCertificate, kStart));
  restored = RestoredTrust({{.sender = 7, .state = TrustState::kSuspect}});
  EXPECT_FALSE(restored.TakeFor(99, {}, kStart));  // No certificate is nobody's.
}

TEST(TrustMemory, WhatIsNotAskedForIsKeptOn) {
  RestoredTrust restored({Suspect(7, 10.0), Suspect(8, 1.0)});
  restored.OnEvent(kStart);
  ASSERT_TRUE(restored.TakeFor(8, {}, kStart));
  const auto left = restored.Left(kStart + FromSeconds(2.0));
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0].sender, 7u);
  EXPECT_DOUBLE_EQ(left[0].since_s, 12.0);
}

TEST(TrustMemory, OfTooManyTheGravestAndNewestStay) {
  std::vector<TrustMemory> all;
  for (SenderId i = 0; i < 2000; ++i) {
    all.push_back({.sender = i, .state = TrustState::kCandidate, .since_s = 1e-3 * i});
  }
  for (SenderId i = 5000; i < 5400; ++i) all.push_back(Suspect(i, 1000.0));
  all.push_back({.sender = 5100, .state = TrustState::kRevoked});
  const auto kept = BoundedTrust(all);
  ASSERT_LE(kept.size(), kMostTrustMemories);
  std::size_t penalties = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i > 0) {
      EXPECT_LT(kept[i - 1].sender, kept[i].sender);
    }
    penalties += kept[i].state != TrustState::kCandidate ? 1 : 0;
    if (kept[i].sender == 5100) {
      EXPECT_EQ(kept[i].state, TrustState::kRevoked);
    }
    if (kept[i].state == TrustState::kCandidate) {
      EXPECT_LT(kept[i].sender, 200u);
    }
  }
  EXPECT_EQ(penalties, 400u);
}

}  // namespace
}  // namespace v2vouch
