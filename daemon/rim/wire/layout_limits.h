// SPDX-License-Identifier: Apache-2.0
// For the tables of layouts only (layout_inputs.cc, layout_lists.cc, layout_status.cc,
// layout_truth.cc): the fields of every type of lcmtypes/, once more, with what lcm-gen's own table
// lacks: how much of each a decoder may believe. tests/daemon/rim/wire/layout_test.cc keeps them
// equal to the .lcm files.
#pragma once

#include "daemon/rim/wire/layout.h"

namespace v2vouch::wire {

inline constexpr int kMaxNameBytes = 256;
inline constexpr int kMaxTextBytes = 1 << 20;
inline constexpr int kMaxImageBytes = 16 << 20;  // 1920 x 1080 bgr8 takes 6.2 million.

}  // namespace v2vouch::wire

#define V2VOUCH_LAYOUT(Type, layout) \
  template <>                        \
  const Layout& LayoutOf<Type>() {   \
    return layout;                   \
  }
