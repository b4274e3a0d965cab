// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// Working memory that an object keeps between calls for its allocation alone: what is in it means
/// nothing once a call is over. Copies of the object (checkpoints) leave it out: a copy starts
/// empty, and an assignment keeps the memory of its target.
template <class T>
struct Scratch : T {
  using T::T;
  Scratch() = default;
  Scratch(const Scratch&) : T() {}
  Scratch& operator=(const Scratch&) { return *this; }
};

}  // namespace v2vouch
