// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/status_encoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "daemon/rim/wire/codec.h"
#include "v2vouch/daemon_status_t.hpp"

namespace v2vouch::wire {
namespace {

// What was refused below the message stands beside what was refused of messages: summed by reason,
// and each by bus and field.
TEST(StatusEncoder, DroppedDatagramsAreAmongTheRefusals) {
  Status status;
  status.refusals[static_cast<std::size_t>(Reason::kWrongType)] = 5;
  status.refusal_details.push_back({"RADAR_FRONT", Refusal(Reason::kWrongType), 5, ""});
  status.dropped = {{"(bus)", "packet_malformed", "magic", 3},
                    {"(bus)", "packet_malformed", "channel", 4},
                    {"(v2v bus)", "message_incomplete", "no room", 1}};
  std::vector<std::uint8_t> bytes;
  EncodeStatus(status, bytes);
  const auto decoded = Decode<daemon_status_t>(bytes);
  ASSERT_TRUE(decoded);
  std::map<std::string, std::int64_t> refusals;
  for (const count_t& each : decoded->refusals) refusals[each.name] = each.count;
  EXPECT_EQ(refusals, (std::map<std::string, std::int64_t>{
                          {"wrong_type", 5}, {"packet_malformed", 7}, {"message_incomplete", 1}}));
  ASSERT_EQ(decoded->num_refusal_details, 4);
  const refusal_t& last = decoded->refusal_details.back();
  EXPECT_EQ(last.channel, "(v2v bus)");
  EXPECT_EQ(last.reason, "message_incomplete");
  EXPECT_EQ(last.field, "no room");
  EXPECT_EQ(last.count, 1);
}

}  // namespace
}  // namespace v2vouch::wire
