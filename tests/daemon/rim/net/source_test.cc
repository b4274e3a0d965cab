// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/net/source.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace v2vouch::net {
namespace {

Source At(const char* text) {
  Source source;
  if (inet_pton(AF_INET6, text, source.address.data()) == 1) return source;
  source.address = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  EXPECT_EQ(inet_pton(AF_INET, text, source.address.data() + 12), 1) << text;
  return source;
}

TEST(Source, IsWrittenInItsOwnForm) {
  EXPECT_EQ(At("192.168.1.7").Text(), "192.168.1.7");
  EXPECT_EQ(At("192.168.1.7").ipv4(), 0xC0A80107u);
  EXPECT_EQ(At("fe80::1").Text(), "fe80::1");
  EXPECT_TRUE(At("::ffff:10.0.0.1").is_ipv4());
}

TEST(SourceFilter, TakesAddressesAndNetworks) {
  SourceFilter filter;
  std::string error;
  EXPECT_TRUE(filter.Allows(At("1.2.3.4")));
  ASSERT_TRUE(SourceFilter::Parse({"192.168.1.0/24", "10.0.0.7", "172.16.0.0/13", "fd00::/8"},
                                  filter, error))
      << error;
  for (const char* good :
       {"192.168.1.0", "192.168.1.255", "10.0.0.7", "172.23.255.255", "fd12::9"}) {
    EXPECT_TRUE(filter.Allows(At(good))) << good;
  }
  for (const char* bad :
       {"192.168.2.0", "192.168.0.255", "10.0.0.6", "172.24.0.0", "fe80::1", "::"}) {
    EXPECT_FALSE(filter.Allows(At(bad))) << bad;
  }
  ASSERT_TRUE(SourceFilter::Parse({"0.0.0.0/0"}, filter, error));
  EXPECT_TRUE(filter.Allows(At("1.2.3.4")));
  EXPECT_FALSE(filter.Allows(At("fd12::9")));
}

// A host's own messages to a group routed to `lo` have no address.
TEST(SourceFilter, NoAddressIsThisHost) {
  SourceFilter filter;
  std::string error;
  ASSERT_TRUE(SourceFilter::Parse({"127.0.0.1"}, filter, error));
  EXPECT_TRUE(filter.Allows(At("0.0.0.0")));
  ASSERT_TRUE(SourceFilter::Parse({"10.0.0.0/8"}, filter, error));
  EXPECT_FALSE(filter.Allows(At("0.0.0.0")));
}

TEST(SourceFilter, WhatIsNoAddressIsNamed) {
  SourceFilter filter;
  for (const char* bad : {"", "localhost", "1.2.3", "1.2.3.4/33", "1.2.3.4/", "1.2.3.4/x",
                          "1.2.3.4/8/8", "fd00::/129", "1.2.3.4/-1"}) {
    std::string error;
    EXPECT_FALSE(SourceFilter::Parse({"10.0.0.1", bad}, filter, error)) << bad;
    EXPECT_THAT(error, testing::HasSubstr(std::string("\"") + bad + "\"")) << bad;
  }
}

}  // namespace
}  // namespace v2vouch::net
