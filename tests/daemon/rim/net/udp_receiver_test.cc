// SPDX-License-Identifier: Apache-2.0
// On the loopback of this machine, with ports of the kernel's choice.
#include "daemon/rim/net/udp_receiver.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

namespace v2vouch::net {
namespace {

using testing::HasSubstr;

constexpr std::size_t kLongest = 2304;

std::unique_ptr<UdpReceiver> Open(const std::string& address, int port, int buffer_bytes,
                                  std::string& error) {
  return UdpReceiver::Open({.address = address,
                            .port = port,
                            .buffer_bytes = buffer_bytes,
                            .longest = kLongest,
                            .batch = 64,
                            .sources = {}},
                           error);
}

class Sender {
 public:
  explicit Sender(int port) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(port));
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Sender() { close(socket_); }
  void Send(const std::vector<std::uint8_t>& bytes) const {
    sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
           sizeof to_);
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

struct Heard {
  std::vector<std::uint8_t> bytes;
  std::string source;
  std::int64_t utime;
  bool is_cut;
};
std::vector<Heard> HearAll(UdpReceiver& receiver, std::size_t count) {
  std::vector<Heard> heard;
  pollfd wait{receiver.descriptor(), POLLIN, 0};
  while (heard.size() < count && poll(&wait, 1, 2000) == 1) {
    receiver.Receive([&](const Datagram& datagram) {
      heard.push_back({{datagram.bytes.begin(), datagram.bytes.end()},
                       datagram.source.Text(),
                       datagram.utime,
                       datagram.is_cut});
    });
  }
  return heard;
}

TEST(UdpReceiver, GivesBytesSourceAndTheKernelsTime) {
  std::string error;
  const auto receiver = Open("127.0.0.1", 0, 1 << 20, error);
  ASSERT_TRUE(receiver) << error;
  EXPECT_GT(receiver->buffer_bytes(), 0);
  const Sender sender(receiver->port());
  for (std::uint8_t i = 0; i < 200; ++i) sender.Send({i, 0x14});
  const auto heard = HearAll(*receiver, 200);
  ASSERT_EQ(heard.size(), 200u);
  const std::int64_t now = std::chrono::duration_cast<std::chrono::microseconds>(
                               std::chrono::system_clock::now().time_since_epoch())
                               .count();
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].bytes, (std::vector<std::uint8_t>{static_cast<std::uint8_t>(i), 0x14}));
    EXPECT_EQ(heard[i].source, "127.0.0.1");
    EXPECT_NEAR(static_cast<double>(heard[i].utime), static_cast<double>(now), 60e6);
    EXPECT_FALSE(heard[i].is_cut);
  }
}

// Failure mode 5: what does not fit is told, not shortened in silence.
TEST(UdpReceiver, EmptyAndTooLongDatagramsAreTold) {
  std::string error;
  const auto receiver = Open("127.0.0.1", 0, 1 << 20, error);
  ASSERT_TRUE(receiver) << error;
  const Sender sender(receiver->port());
  sender.Send({});
  sender.Send(std::vector<std::uint8_t>(600, 1));
  sender.Send(std::vector<std::uint8_t>(kLongest, 2));
  sender.Send(std::vector<std::uint8_t>(kLongest + 1, 3));
  sender.Send(std::vector<std::uint8_t>(9000, 4));
  const auto heard = HearAll(*receiver, 5);
  ASSERT_EQ(heard.size(), 5u);
  EXPECT_TRUE(heard[0].bytes.empty());
  EXPECT_EQ(heard[1].bytes.size(), 600u);
  EXPECT_FALSE(heard[2].is_cut);
  EXPECT_TRUE(heard[3].is_cut);
  EXPECT_TRUE(heard[4].is_cut);
}

TEST(UdpReceiver, DropsOfAFullBufferAreCounted) {
  std::string error;
  const auto receiver = Open("127.0.0.1", 0, 4096, error);
  ASSERT_TRUE(receiver) << error;
  const Sender sender(receiver->port());
  for (int i = 0; i < 500; ++i) sender.Send(std::vector<std::uint8_t>(1000, 1));
  HearAll(*receiver, 1);
  while (receiver->Receive([](const Datagram&) {}) > 0) {
  }
  sender.Send({1});  // The count comes with the next one.
  HearAll(*receiver, 1);
  EXPECT_GT(receiver->kernel_drops(), 0);
}

TEST(UdpReceiver, WrongAddressesAndTakenPortsAreTold) {
  std::string error;
  EXPECT_FALSE(Open("localhost", 1, 1, error));
  EXPECT_THAT(error, HasSubstr("no IPv4 or IPv6 address"));
  const auto first = Open("127.0.0.1", 0, 1 << 16, error);
  ASSERT_TRUE(first);
  EXPECT_FALSE(Open("127.0.0.1", first->port(), 1 << 16, error));
  EXPECT_THAT(error, HasSubstr("in use"));
}

TEST(UdpReceiver, StrangersAreCountedAndNotHeard) {
  UdpOptions options{.address = "127.0.0.1"};
  std::string error;
  ASSERT_TRUE(SourceFilter::Parse({"127.0.0.2"}, options.sources, error)) << error;
  const auto receiver = UdpReceiver::Open(options, error);
  ASSERT_TRUE(receiver) << error;
  const Sender sender(receiver->port());
  sender.Send({1});
  ASSERT_TRUE(receiver->Wait(2000));
  EXPECT_EQ(receiver->Receive([](const Datagram&) { FAIL(); }), 1);
  EXPECT_EQ(receiver->strangers(), 1);
}

}  // namespace
}  // namespace v2vouch::net
