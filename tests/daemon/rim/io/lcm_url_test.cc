// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/lcm_url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "daemon/rim/io/lcm_bus.h"

namespace v2vouch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LcmUrl, WhatLcmUnderstandsIsGood) {
  for (const char* url :
       {"", "udpm://", "udpm://?ttl=1", "udpm://239.255.76.67:7667", "udpm://224.0.0.1:1?ttl=255",
        "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304", "mpudpm://239.255.76.67:7667",
        "memq://", "tcpq://localhost:7700", "file:///tmp/new.lcm?mode=w"}) {
    EXPECT_THAT(LcmUrlProblems(url), IsEmpty()) << url;
  }
  const std::string log = testing::TempDir() + "/lcm_url_test.lcm";
  std::ofstream(log) << "x";
  EXPECT_THAT(LcmUrlProblems("file://" + log + "?speed=0&start_timestamp=17"), IsEmpty());
}

TEST(LcmUrl, EachFaultIsNamed) {
  const auto only = [](const char* url) {
    const auto problems = LcmUrlProblems(url);
    EXPECT_EQ(problems.size(), 1u) << url;
    return CheckLcmUrl(url);
  };
  EXPECT_THAT(only("udpm"), HasSubstr("must begin with a provider"));
  EXPECT_THAT(only("udp://239.255.76.67:7667"), HasSubstr("unknown provider \"udp\""));
  EXPECT_THAT(only("://239.255.76.67:7667"), HasSubstr("unknown provider \"\""));
  EXPECT_THAT(only("udpm://239.255.76.67"), HasSubstr("has no port"));
  EXPECT_THAT(only("udpm://239.255.76.67?ttl=0"), HasSubstr("has no port"));
  EXPECT_THAT(only("udpm://239.255.76.67:"), HasSubstr("port = \"\""));
  EXPECT_THAT(only("udpm://239.255.76.67:0"), HasSubstr("from 1 to 65535"));
  EXPECT_THAT(only("udpm://239.255.76.67:70000"), HasSubstr("port = \"70000\""));
  EXPECT_THAT(only("udpm://239.255.76.67:76x7"), HasSubstr("port = \"76x7\""));
  EXPECT_THAT(only("udpm://127.0.0.1:7667"), HasSubstr("must be a multicast address"));
  EXPECT_THAT(only("udpm://nonsense:7667"), HasSubstr("group \"nonsense\""));
  EXPECT_THAT(only("udpm://239.255.76.67:7667?ttl=256"), HasSubstr("ttl = \"256\""));
  EXPECT_THAT(only("udpm://239.255.76.67:7667?ttl"), HasSubstr("ttl = \"\""));
  EXPECT_THAT(only("udpm://239.255.76.67:7667?recv_buf_size=4MB"), HasSubstr("recv_buf_size"));
  EXPECT_THAT(only("udpm://239.255.76.67:7667?recv_buffer=1"),
              HasSubstr("unknown option \"recv_buffer\"; known: ttl, recv_buf_size"));
  EXPECT_THAT(only("tcpq://localhost"), HasSubstr("has no port"));
  EXPECT_THAT(only("tcpq://:7700"), HasSubstr("names no host"));
  EXPECT_THAT(only("memq://x"), HasSubstr("takes no address"));
  EXPECT_THAT(only("file://"), HasSubstr("names no file"));
  EXPECT_THAT(only("file:///no/such.lcm"), HasSubstr("there is no file"));
  EXPECT_THAT(only("file:///tmp/a.lcm?mode=x"), HasSubstr("must be r, w or a"));
}

TEST(LcmUrl, AllFaultsAreNamedAtOnce) {
  EXPECT_THAT(
      LcmUrlProblems("udpm://127.0.0.1:x?ttl=-1&a=b"),
      ElementsAre(HasSubstr("port"), HasSubstr("group"), HasSubstr("ttl"), HasSubstr("\"a\"")));
}

// liblcm 1.3.1 aborts the whole program at this one.
TEST(LcmUrl, ABusOfAWrongUrlIsNotOpened) {
  EXPECT_EQ(LcmBus::Open("tcpq://"), nullptr);
  EXPECT_NE(LcmBus::Open("memq://"), nullptr);
}

TEST(LcmUrl, PortIsToldForUdp) {
  EXPECT_EQ(LcmUdpPort(""), 7667);
  EXPECT_EQ(LcmUdpPort("udpm://?ttl=0"), 7667);
  EXPECT_EQ(LcmUdpPort("udpm://239.255.76.68:7668?ttl=0"), 7668);
  EXPECT_EQ(LcmUdpPort("memq://"), 0);
}

}  // namespace
}  // namespace v2vouch
