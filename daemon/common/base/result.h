// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <variant>

#include "daemon/common/base/check.h"
#include "daemon/common/base/reason.h"

namespace v2vouch {

/// A value, or the reason why there is none. A refusal is an ordinary result.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}       // NOLINT(google-explicit-constructor)
  Result(Reason reason) : content_(Refusal(reason)) {}  // NOLINT(google-explicit-constructor)
  Result(Refusal refusal) : content_(refusal) {}        // NOLINT(google-explicit-constructor)

  explicit operator bool() const { return std::holds_alternative<T>(content_); }
  const T& operator*() const { return value(); }
  const T* operator->() const { return &value(); }
  T& operator*() { return value(); }
  T* operator->() { return &value(); }

  [[nodiscard]] const T& value() const {
    V2VOUCH_CHECK(*this);
    return *std::get_if<T>(&content_);
  }
  [[nodiscard]] T& value() {
    V2VOUCH_CHECK(*this);
    return *std::get_if<T>(&content_);
  }
  [[nodiscard]] Reason reason() const { return refusal().reason; }
  /// The reason with the field that it is about.
  [[nodiscard]] const Refusal& refusal() const {
    V2VOUCH_CHECK(!*this);
    return *std::get_if<Refusal>(&content_);
  }

 private:
  std::variant<T, Refusal> content_;
};

}  // namespace v2vouch
