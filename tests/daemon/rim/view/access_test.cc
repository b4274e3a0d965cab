// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/access.h"

#include <gtest/gtest.h>

namespace v2vouch::view {
namespace {

const AccessRules kRules{8790, "00ff", {"car.example"}, {"https://app.example"}};

TEST(Access, HostsAreLiteralLoopbackAddressesWithOurPort) {
  for (const char* host : {"localhost:8790", "127.0.0.1:8790", "127.9.8.7:8790", "[::1]:8790",
                           "LocalHost:8790", "car.example:8790"}) {
    EXPECT_TRUE(IsHostAllowed(kRules, host)) << host;
  }
  for (const char* host : {"",
                           "localhost",
                           "localhost:80",
                           "127.0.0.1.attacker.example:8790",
                           "127.1:8790",
                           "127.0.0.256:8790",
                           "127.0.0.01:8790",
                           "0x7f.0.0.1:8790",
                           "2130706433:8790",
                           "10.0.0.1:8790",
                           "attacker.example:8790",
                           "localhost.attacker.example:8790",
                           "127.0.0.1:8790:8790",
                           "127.0.0.1.:8790",
                           " 127.0.0.1:8790",
                           "[::ffff:127.0.0.1]:8790",
                           "0.0.0.0:8790",
                           "car.example.attacker.example:8790",
                           ":8790",
                           "127.0.0.1:08790"}) {
    EXPECT_FALSE(IsHostAllowed(kRules, host)) << host;
  }
}

TEST(Access, AnOriginIsOursOrNamedOrNone) {
  EXPECT_TRUE(IsOriginAllowed(kRules, "127.0.0.1:8790", ""));
  EXPECT_TRUE(IsOriginAllowed(kRules, "127.0.0.1:8790", "http://127.0.0.1:8790"));
  EXPECT_TRUE(IsOriginAllowed(kRules, "127.0.0.1:8790", "https://app.example"));
  for (const char* origin :
       {"null", "http://127.0.0.1:8791", "http://localhost:8790", "https://127.0.0.1:8790",
        "http://attacker.example", "https://app.example.attacker.example"}) {
    EXPECT_FALSE(IsOriginAllowed(kRules, "127.0.0.1:8790", origin)) << origin;
  }
}

TEST(Access, TheTokenComesInTheQueryOrAsASubProtocol) {
  EXPECT_TRUE(HasToken(kRules, "/?t=00ff", ""));
  EXPECT_TRUE(HasToken(kRules, "/?a=b&t=00ff", ""));
  EXPECT_TRUE(HasToken(kRules, "/", "v2vouch.view.v1, v2vouch.token.00ff"));
  for (const char* target :
       {"/", "/?t=", "/?t=00f", "/?t=00ff0", "/?t=00fe", "/?xt=00ff", "/t=00ff"}) {
    EXPECT_FALSE(HasToken(kRules, target, "v2vouch.view.v1,v2vouch.token.")) << target;
  }
  EXPECT_TRUE(HasToken({8790, "", {}, {}}, "/", ""));
}

TEST(Access, BothNamesOfFoxglovesProtocolAreSpoken) {
  EXPECT_EQ(ChooseProtocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(ChooseProtocol("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(ChooseProtocol("v2vouch.view.v1,v2vouch.token.ab"), "v2vouch.view.v1");
  EXPECT_FALSE(ChooseProtocol("foxglove.sdk.v2").has_value());
  EXPECT_FALSE(ChooseProtocol("").has_value());
}

}  // namespace
}  // namespace v2vouch::view
