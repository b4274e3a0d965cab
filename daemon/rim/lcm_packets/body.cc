// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/lcm_packets/body.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <new>

namespace v2vouch::lcm_packets {
namespace {

constexpr std::size_t kPerPiece = 128;  // Of the map's node and the vector.
constexpr std::size_t kFirstBytes = 4096;

}  // namespace

void Buffer::Grow(std::size_t bytes, std::size_t most) {
  if (bytes <= capacity_) return;
  const std::size_t wanted = std::max(bytes, std::min(most, std::max(kFirstBytes, 2 * capacity_)));
  auto* const grown = static_cast<std::uint8_t*>(std::realloc(data_.get(), wanted));
  if (grown == nullptr) throw std::bad_alloc();
  static_cast<void>(data_.release());  // realloc has freed or moved it.
  data_.reset(grown);
  capacity_ = wanted;
}

void Body::Append(std::span<const std::uint8_t> bytes) {
  buffer_.Grow(begun_ + bytes.size(), size_);
  std::memcpy(buffer_.data() + begun_, bytes.data(), bytes.size());
  begun_ += bytes.size();
}

bool Body::Add(std::size_t offset, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return true;
  if (offset < begun_) return false;
  const auto next = pieces_.lower_bound(offset);
  if (next != pieces_.end() && next->first < offset + bytes.size()) return false;
  if (next != pieces_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second.size() > offset) return false;
  }
  if (offset > begun_) {
    pieces_.emplace_hint(next, offset, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    apart_ += bytes.size() + kPerPiece;
    apart_bytes_ += bytes.size();
    return true;
  }
  Append(bytes);
  while (!pieces_.empty() && pieces_.begin()->first == begun_) {
    const auto piece = pieces_.begin();
    Append(piece->second);
    apart_ -= piece->second.size() + kPerPiece;
    apart_bytes_ -= piece->second.size();
    pieces_.erase(piece);
  }
  return true;
}

}  // namespace v2vouch::lcm_packets
