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
        "udpm://?receiver=own", "udpm://?receiver=liblcm",
        "udpm://239.255.76.67:7667?from=192.168.1.0/24,127.0.0.1&ttl=1", "memq://",
        "tcpq://localhost:7700", "file:///tmp/new.lcm?mode=w"}) {
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
  EXPECT_THAT(only("udpm://?receiver=ours"), HasSubstr("must be own or liblcm"));
  EXPECT_THAT(only("udpm://?from=vehicle"), HasSubstr("\"vehicle\" is no address"));
  EXPECT_THAT(only("udpm://?from=10.0.0.1,,10.0.0.2"), HasSubstr("\"\" is no address"));
  EXPECT_THAT(only("udpm://?receiver=liblcm&from=10.0.0.1"), HasSubstr("receiver=own can choose"));
  EXPECT_THAT(only("mpudpm://?receiver=own"), HasSubstr("unknown option \"receiver\""));
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
  EXPECT_EQ(LcmBus::Open("tcpq://127.0.0.1:1"), nullptr);  // Nobody listens there.
  EXPECT_NE(LcmBus::Open("memq://"), nullptr);
}

TEST(LcmUrl, OurOwnOptionsAreKeptFromLiblcm) {
  EXPECT_EQ(UrlForLiblcm(""), "");
  EXPECT_EQ(UrlForLiblcm("udpm://239.255.76.67:7667"), "udpm://239.255.76.67:7667");
  EXPECT_EQ(UrlForLiblcm("udpm://?receiver=own&ttl=1&from=127.0.0.1&recv_buf_size=9"),
            "udpm://?ttl=1&recv_buf_size=9");
  EXPECT_EQ(UrlForLiblcm("memq://"), "memq://");
}

TEST(LcmUrl, UdpIsReceivedByOurselvesUnlessToldOtherwise) {
  for (const char* url : {"memq://", "mpudpm://239.255.76.67:7667", "udpm://?receiver=liblcm"}) {
    EXPECT_FALSE(OwnReceiverUrl(url)) << url;
  }
  const auto stock = OwnReceiverUrl("");
  ASSERT_TRUE(stock);
  EXPECT_EQ(stock->group, "239.255.76.67");
  EXPECT_EQ(stock->port, 7667);
  EXPECT_TRUE(stock->sources.empty());
  const auto given = OwnReceiverUrl(
      "udpm://239.255.76.68:7668?receiver=own&from=10.0.0.1,10.1.0.0/16&recv_buf_size=100000");
  ASSERT_TRUE(given);
  EXPECT_EQ(given->group, "239.255.76.68");
  EXPECT_EQ(given->port, 7668);
  EXPECT_EQ(given->receive_buffer_bytes, 100000);
  EXPECT_THAT(given->sources, ElementsAre("10.0.0.1", "10.1.0.0/16"));
}

TEST(LcmUrl, PortIsToldForUdp) {
  EXPECT_EQ(LcmUdpPort(""), 7667);
  EXPECT_EQ(LcmUdpPort("udpm://?ttl=0"), 7667);
  EXPECT_EQ(LcmUdpPort("udpm://239.255.76.68:7668?ttl=0"), 7668);
  EXPECT_EQ(LcmUdpPort("memq://"), 0);
}

}  // namespace
}  // namespace v2vouch
