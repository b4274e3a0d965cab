// SPDX-License-Identifier: Apache-2.0
#include "daemon/v2v/gps_bias/residual_window.h"

#include <Eigen/LU>
#include <algorithm>

namespace v2vouch {
namespace {

// The end of the second that `stamp` lies in.
std::int64_t EndOf(Timestamp stamp) {
  const std::int64_t us = ToMicros(stamp);
  return us / kSecond_us + (us % kSecond_us > 0 ? 1 : 0);
}

}  // namespace

void ResidualWindow::Add(const BiasResidual& residual) {
  const Eigen::Matrix2d& P = residual.covariance;
  if (!residual.claimed_minus_sensed_en.allFinite() || !P.allFinite()) return;
  if (!(P(0, 0) > 0.0) || !(P.determinant() > 0.0)) return;
  Sender* sender = FindOrMake(residual.sender, residual.stamp);
  if (sender == nullptr || residual.stamp < sender->last) return;
  sender->last = residual.stamp;
  const std::int64_t second = EndOf(residual.stamp);
  if (sender->sums.empty() || sender->sums.back().second != second) {
    sender->sums.push_back({.second = second});
  }
  Sum& sum = sender->sums.back();
  sum.age_s += ToSeconds(FromMicros(second * kSecond_us) - residual.stamp);
  sum.residual += residual.claimed_minus_sensed_en;
  sum.covariance += P;
  ++sum.count;
}

ResidualWindow::Sender* ResidualWindow::FindOrMake(SenderId id, Timestamp now) {
  auto at = std::ranges::lower_bound(senders_, id, {}, &Sender::id);
  if (at != senders_.end() && at->id == id) return &*at;
  if (senders_.size() >= static_cast<std::size_t>(config_.max_senders)) {
    const auto stalest = std::ranges::min_element(senders_, {}, &Sender::last);
    if (stalest->last >= now) return nullptr;
    senders_.erase(stalest);
    at = std::ranges::lower_bound(senders_, id, {}, &Sender::id);
  }
  return &*senders_.insert(at, Sender{id, now, {}});
}

void ResidualWindow::Forget(Timestamp now) {
  const Timestamp oldest = now - FromSeconds(config_.window_s);
  for (Sender& sender : senders_) {
    while (!sender.sums.empty() && FromMicros(sender.sums.front().second * kSecond_us) <= oldest) {
      sender.sums.pop_front();
    }
  }
  std::erase_if(senders_, [](const Sender& sender) { return sender.sums.empty(); });
}

std::vector<SenderBlocks> ResidualWindow::At(Timestamp second) const {
  std::vector<SenderBlocks> all;
  const Timestamp oldest = second - FromSeconds(config_.window_s);
  for (const Sender& sender : senders_) {
    SenderBlocks one;
    one.sender = sender.id;
    for (const Sum& sum : sender.sums) {
      const Timestamp end = FromMicros(sum.second * kSecond_us);
      if (end <= oldest || end > second) continue;
      const double n = sum.count;
      const double independent = std::min(n, config_.white_hz);
      one.blocks.push_back({.stamp = end - FromSeconds(sum.age_s / n),
                            .mean_en = sum.residual / n,
                            .covariance = sum.covariance / (n * independent),
                            .residuals = sum.count});
      one.residuals += sum.count;
    }
    if (!one.blocks.empty()) all.push_back(std::move(one));
  }
  return all;
}

}  // namespace v2vouch
