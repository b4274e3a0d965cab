// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace v2vouch::lcm_packets {

/// Memory that grows without being filled, and may be handed on to be used again.
class Buffer {
 public:
  /// At least `bytes`, at most `most`; what is held is kept. @throws std::bad_alloc
  void Grow(std::size_t bytes, std::size_t most);
  [[nodiscard]] std::uint8_t* data() const { return data_.get(); }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

 private:
  struct Free {
    void operator()(std::uint8_t* data) const { std::free(data); }
  };
  std::unique_ptr<std::uint8_t, Free> data_;
  std::size_t capacity_ = 0;
};

/// The bytes of a message as its fragments bring them. Takes memory for what has come, not for what
/// was announced: the beginning in one piece, and what came before its turn apart.
class Body {
 public:
  explicit Body(std::size_t size = 0, Buffer buffer = {})
      : size_(size), buffer_(std::move(buffer)) {}

  /// @return false, and nothing changed, where some of these bytes are here already.
  bool Add(std::size_t offset, std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool is_complete() const { return begun_ == size_; }
  /// What it takes, bookkeeping included.
  [[nodiscard]] std::size_t held() const { return begun_ + apart_; }
  /// Bytes that have come.
  [[nodiscard]] std::size_t received() const { return begun_ + apart_bytes_; }
  Buffer Release() { return std::move(buffer_); }

 private:
  void Append(std::span<const std::uint8_t> bytes);

  std::size_t size_;
  std::size_t begun_ = 0;  // Bytes from the beginning that are here.
  Buffer buffer_;
  std::map<std::size_t, std::vector<std::uint8_t>> pieces_;  // By offset; all beyond begun_.
  std::size_t apart_ = 0;
  std::size_t apart_bytes_ = 0;
};

}  // namespace v2vouch::lcm_packets
