// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/trust/tombstones.h"

#include <algorithm>

namespace v2vouch {
namespace {

bool IsGiven(const CertificateDigest& certificate) { return certificate != CertificateDigest{}; }

}  // namespace

void Tombstones::Set(const Stone& stone) {
  const auto end = stones_.begin() + static_cast<std::ptrdiff_t>(count_);
  auto at = std::find_if(stones_.begin(), end,
                         [&](const Stone& other) { return other.sender == stone.sender; });
  if (at == end) {
    if (count_ < kStones) {
      ++count_;
    } else {
      at = std::min_element(stones_.begin(), end,
                            [](const Stone& a, const Stone& b) { return a.last < b.last; });
    }
  }
  *at = stone;
}

void Tombstones::Remove(SenderId sender) {
  for (std::size_t i = 0; i < count_; ++i) {
    if (stones_[i].sender != sender) continue;
    std::move(stones_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
              stones_.begin() + static_cast<std::ptrdiff_t>(count_),
              stones_.begin() + static_cast<std::ptrdiff_t>(i));
    --count_;
    return;
  }
}

const Tombstones::Stone* Tombstones::Find(SenderId sender) const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (stones_[i].sender == sender) return &stones_[i];
  }
  return nullptr;
}

std::optional<Tombstones::Stone> Tombstones::TakeFor(
    SenderId sender, const CertificateDigest& certificate, Timestamp first_heard, Timestamp now,
    const Eigen::Vector2d& p_O, const Eigen::Vector2d& v_O, const TombstoneConfig& config) {
  for (std::size_t i = 0; i < count_; ++i) {
    const Stone& stone = stones_[i];
    if (stone.sender == sender) continue;
    const double since_s = ToSeconds(now - stone.last);
    if (since_s > config.memory_s) continue;
    const bool is_same_certificate = IsGiven(certificate) && certificate == stone.certificate;
    if (!is_same_certificate) {
      if (first_heard <= stone.last) continue;
      const double reach_m = config.gate_m + 0.5 * config.gate_mps2 * since_s * since_s;
      if ((stone.p_O + since_s * stone.v_O - p_O).norm() > reach_m) continue;
      if ((stone.v_O - v_O).norm() > config.gate_mps + config.gate_mps2 * since_s) continue;
    }
    const Stone taken = stone;
    Remove(taken.sender);
    return taken;
  }
  return std::nullopt;
}

}  // namespace v2vouch
