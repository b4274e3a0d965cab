// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <v2vouch/track_list_t.hpp>

int main() {
  v2vouch::track_list_t list{};
  std::puts(list.num_tracks == 0 && list.getHash() != 0 ? "good" : "bad");
}
