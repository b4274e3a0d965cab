// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/channel_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/rim/message_schema/walk.h"

namespace v2vouch::spy {
namespace {

constexpr std::int64_t kHalfSecond_us = 500'000;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// The two fields of a message that tell of its way: its time and its counter.
class HeadReader : public message_schema::Visitor {
 public:
  void BeginStruct(const message_schema::Type&) override { ++depth_; }
  void EndStruct() override { --depth_; }
  void Name(const message_schema::Field& field) override {
    wanted_ = nullptr;
    if (depth_ != 1) return;
    if (field.name == "utime" || field.name == "rx_utime") wanted_ = &utime;
    if (field.name == "seq") wanted_ = &seq;
  }
  void Integer(std::int64_t value) override {
    if (wanted_ != nullptr) *wanted_ = value;
    wanted_ = nullptr;
  }
  std::optional<std::int64_t> utime, seq;

 private:
  int depth_ = 0;
  std::optional<std::int64_t>* wanted_ = nullptr;
};

void CountSequence(ChannelRow& row, std::int64_t seq) {
  if (row.seq) {
    const auto step = static_cast<std::uint64_t>(seq) - static_cast<std::uint64_t>(*row.seq);
    // A step of millions is a sender that began anew, not a loss.
    if (step == 0 || step > std::uint64_t{1} << 62U) {
      ++row.repeats;
    } else if (step > 1 && step < 1'000'000) {
      row.gaps += static_cast<std::int64_t>(step) - 1;
    }
  }
  row.seq = seq;
}

void CountArrival(ChannelRow& row, std::size_t bytes, std::int64_t arrived_us) {
  if (row.messages == 0) {
    row.first_us = arrived_us;
  } else {
    const double interval_s =
        1e-6 * (static_cast<double>(arrived_us) - static_cast<double>(row.last_us));
    row.interval_sum_s += interval_s;
    row.interval_square_s2 += interval_s * interval_s;
  }
  row.last_us = arrived_us;
  ++row.messages;
  row.bytes += static_cast<std::int64_t>(bytes);
  const std::int64_t half_second = arrived_us / kHalfSecond_us;
  const auto slot = static_cast<std::size_t>(std::abs(half_second % 20));
  ChannelRow::Bucket& bucket = row.buckets[slot];
  if (bucket.half_second != half_second) bucket = {half_second, 0, 0};
  ++bucket.messages;
  bucket.bytes += static_cast<std::int64_t>(bytes);
}

// Sum over the full half seconds before `now_us`.
template <class Member>
double PerSecond(const ChannelRow& row, std::int64_t now_us, double seconds, Member member) {
  const auto halves = std::clamp<std::int64_t>(std::llround(2.0 * seconds), 1, 18);
  const std::int64_t now = now_us / kHalfSecond_us;
  std::int64_t sum = 0;
  for (const ChannelRow::Bucket& bucket : row.buckets) {
    if (bucket.half_second >= now - halves && bucket.half_second < now) sum += bucket.*member;
  }
  return 2.0 * static_cast<double>(sum) / static_cast<double>(halves);
}

}  // namespace

double ChannelRow::Rate(std::int64_t now_us, double seconds) const {
  return PerSecond(*this, now_us, seconds, &Bucket::messages);
}

double ChannelRow::BytesPerSecond(std::int64_t now_us, double seconds) const {
  return PerSecond(*this, now_us, seconds, &Bucket::bytes);
}

double ChannelRow::MeanRate() const {
  return messages > 1 && interval_sum_s > 0.0 ? static_cast<double>(messages - 1) / interval_sum_s
                                              : kNone;
}

double ChannelRow::Jitter() const {
  if (messages < 3) return kNone;
  const auto n = static_cast<double>(messages - 1);
  const double mean = interval_sum_s / n;
  return std::sqrt(std::max(0.0, interval_square_s2 / n - mean * mean));
}

std::string WhyRefused(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return "shorter than a fingerprint";
  const message_schema::Type* type = message_schema::TypeOf(bytes);
  if (type == nullptr) return "";
  message_schema::Visitor nobody;
  if (message_schema::Walk(*type, bytes, nobody)) return "";
  return "broken " + std::string(type->name);
}

void ChannelTable::Take(std::string_view channel, std::span<const std::uint8_t> bytes,
                        std::int64_t arrived_us) {
  ++messages_;
  last_us_ = std::max(last_us_, arrived_us);
  auto found = rows_.find(std::string(channel));
  if (found == rows_.end()) {
    const bool has_room = rows_.size() < kMostChannels;
    found = rows_.try_emplace(has_room ? std::string(channel) : kOtherChannels).first;
  }
  ChannelRow& row = found->second;
  CountArrival(row, bytes.size(), arrived_us);
  row.type = message_schema::TypeOf(bytes);
  row.fingerprint = message_schema::FingerprintOf(bytes);
  row.newest.clear();
  if (bytes.size() <= kMostKept) row.newest.assign(bytes.begin(), bytes.end());
  const std::string why = WhyRefused(bytes);
  if (!why.empty()) {
    // One reason per type of ours and one more: bounded.
    ++row.refused[why];
    return;
  }
  if (row.type == nullptr) return;
  HeadReader head;
  message_schema::Walk(*row.type, bytes, head);
  row.stamp_us = head.utime;
  if (head.seq) CountSequence(row, *head.seq);
}

const ChannelRow* ChannelTable::Find(const std::string& channel) const {
  const auto found = rows_.find(channel);
  return found == rows_.end() ? nullptr : &found->second;
}

}  // namespace v2vouch::spy
