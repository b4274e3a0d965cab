// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/trust_memory.h"

#include <algorithm>
#include <tuple>

namespace v2vouch {

std::vector<TrustMemory> BoundedTrust(std::vector<TrustMemory> all) {
  // TrustState's values rise with gravity from CANDIDATE to REVOKED.
  std::ranges::sort(all, [](const TrustMemory& a, const TrustMemory& b) {
    return std::tuple(b.state, a.since_s, a.sender) < std::tuple(a.state, b.since_s, b.sender);
  });
  if (all.size() > kMostTrustMemories) all.resize(kMostTrustMemories);
  std::ranges::stable_sort(all, {}, &TrustMemory::sender);
  const auto rest = std::ranges::unique(all, {}, &TrustMemory::sender);
  all.erase(rest.begin(), rest.end());
  return all;
}

std::optional<TrustMemory> RestoredTrust::TakeFor(SenderId sender,
                                                  const CertificateDigest& certificate,
                                                  Timestamp now) {
  const bool is_signed = certificate != CertificateDigest{};
  auto found = std::ranges::find(memories_, sender, &TrustMemory::sender);
  if (found == memories_.end() && is_signed) {
    found = std::ranges::find(memories_, certificate, &TrustMemory::certificate);
  }
  if (found == memories_.end()) return std::nullopt;
  const TrustMemory taken = Aged(*found, now);
  memories_.erase(found);
  return taken;
}

TrustState RestoredTrust::StateOf(SenderId sender) const {
  const auto found = std::ranges::find(memories_, sender, &TrustMemory::sender);
  return found == memories_.end() ? TrustState::kNone : found->state;
}

std::vector<TrustMemory> RestoredTrust::Left(Timestamp now) const {
  std::vector<TrustMemory> left;
  left.reserve(memories_.size());
  for (const TrustMemory& memory : memories_) left.push_back(Aged(memory, now));
  return left;
}

TrustMemory RestoredTrust::Aged(TrustMemory memory, Timestamp now) const {
  const double gone_s = began_ ? std::max(0.0, ToSeconds(now - *began_)) : 0.0;
  memory.since_s += gone_s;
  memory.finding_s += gone_s;
  return memory;
}

}  // namespace v2vouch
