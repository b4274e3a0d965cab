// SPDX-License-Identifier: Apache-2.0
// v2vouchd over UDP while somebody on the bus sends what kills, corrupts or starves liblcm 1.3.1:
// every datagram is counted under its reason, and the drive beside gives the lists it always gives.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "daemon/rim/engine/engine.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/played_drive.h"
#include "tests/integration/program.h"
#include "tests/support/lcm_datagrams.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::DigestOf;
using testing::DriveMessages;
using testing::Eventually;
using testing::FragmentDatagram;
using testing::FragmentHeader;
using testing::Fragments;
using testing::Octets;
using testing::Pattern;
using testing::Play;
using testing::Program;
using testing::ShortDatagram;
using testing::WireMessage;
using testing::WithChannel;

constexpr char kRadar[] = "RADAR_FRONT";

// A socket on the bus, which is what LCM takes for a sender.
class Attacker {
 public:
  explicit Attacker(const char* to = nullptr) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const auto url = OwnReceiverUrl(EffectiveLcmUrl(""));
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(url->port));
    inet_pton(AF_INET, to != nullptr ? to : url->group.c_str(), &to_.sin_addr);
  }
  ~Attacker() { close(socket_); }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;

  void Send(const Octets& datagram) {
    sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
           sizeof to_);
    // In step with the receiver: what the kernel drops is not counted by us.
    if (++sent_ % 50 == 0) std::this_thread::sleep_for(2ms);
  }

 private:
  int socket_;
  sockaddr_in to_{};
  int sent_ = 0;
};

Octets First(std::size_t bytes) { return WithChannel(kRadar, Octets(bytes, 1)); }

// What must be counted on "(bus)": reason and field -> how often.
using Expected = std::map<std::string, std::int64_t>;
constexpr char kIncomplete[] = "message_incomplete";

// Headers that cannot be, one datagram each.
void SendMalformed(Expected& expected) {
  Attacker one;
  const auto send = [&](const Octets& datagram, const std::string& what) {
    one.Send(datagram);
    ++expected[what];
  };
  const std::string malformed = "packet_malformed ";
  for (const std::size_t size : {0, 1, 3, 4, 7})
    send(Octets(size, 'L'), malformed + "datagram size");
  send({'L', 'C', '0', '2', 0, 0, 0, 1}, malformed + "channel");  // A bare short header.
  send({'L', 'C', '0', '3', 0, 0, 0, 1, 0, 0, 0, 1}, malformed + "datagram size");
  send({0xDE, 0xAD, 0xBE, 0xEF, 0, 0, 0, 1, 'A', 0}, malformed + "magic");
  send({'L', 'C', '0', '4', 0, 0, 0, 1, 'A', 0}, malformed + "magic");
  send({'L', 'C', '0', '2', 0, 0, 0, 1, 'A', 'B', 'C'}, malformed + "channel");
  send(ShortDatagram(1, "", {1}), malformed + "channel");
  for (const std::size_t length : {64, 65, 1000, 60'000}) {
    send(ShortDatagram(1, std::string(length, 'A'), {}), malformed + "channel");
  }
  const auto fragment = [&](const FragmentHeader& header, const std::string& what) {
    send(FragmentDatagram(header, First(80)), what);
  };
  for (const std::uint32_t offset :
       {0xFFFFFFF0U, 0xFFFFFFFFU, 0xFFFFFF9CU, 0x7FFFFFFFU, 101U, 2000U}) {
    fragment({7, 2000, offset, 1, 2}, offset == 101 ? "" : malformed + "fragment_offset");
  }
  expected.erase("");  // That one lies inside; its message is never completed.
  ++expected[kIncomplete];
  fragment({8, 2000, 5, 0, 2}, malformed + "fragment_offset");
  fragment({8, 2000, 100, 1, 0}, malformed + "fragments_in_msg");
  fragment({8, 3, 0, 1, 5}, malformed + "fragments_in_msg");
  fragment({8, 2000, 100, 2, 2}, malformed + "fragment_no");
  fragment({8, 2000, 100, 0xFFFF, 2}, malformed + "fragment_no");
  fragment({8, 0, 0, 0, 2}, malformed + "msg_size");
  fragment({8, 0xFFFFFFFF, 0, 0, 2}, malformed + "msg_size");
  fragment({8, 0xFFFFFFFF, 0, 0, 0xFFFF}, malformed + "msg_size");
  fragment({8, 0x7FFFFFFF, 0, 0, 0xFFFF}, "packet_too_large msg_size");
  send(FragmentDatagram({8, 2000, 100, 1, 2}, {}), malformed + "empty fragment");
  send(FragmentDatagram({8, 2000, 0, 0, 2}, Octets(100, 'A')), malformed + "channel");
  send(FragmentDatagram({8, 2000, 0, 0, 2}, Octets(10, 'A')), malformed + "channel");
  send(FragmentDatagram({8, 2000, 0, 0, 2}, {0, 1, 2}), malformed + "channel");
}

// The packet that ends liblcm: a good first fragment, then one whose offset wraps.
void SendWrappedOffset(Expected& expected) {
  Attacker one;
  one.Send(FragmentDatagram({1, 200'000, 0, 0, 4}, First(60'000)));
  one.Send(FragmentDatagram({1, 200'000, 0xFFFFFFF0, 1, 4}, Octets(60'000, 0x41)));
  ++expected["packet_malformed fragment_offset"];
  ++expected[kIncomplete];
}

void SendContradictions(Expected& expected) {
  Attacker one;
  const auto begin = [&](std::uint32_t sequence) {
    one.Send(FragmentDatagram({sequence, 900, 0, 0, 3}, First(300)));
    ++expected[kIncomplete];
  };
  begin(1);
  one.Send(FragmentDatagram({1, 901, 300, 1, 3}, Octets(300, 1)));  // Another total.
  one.Send(FragmentDatagram({1, 100, 0, 0, 3}, First(50)));
  expected["packet_contradicts msg_size"] += 2;
  one.Send(FragmentDatagram({1, 900, 300, 1, 4}, Octets(300, 1)));
  ++expected["packet_contradicts fragments_in_msg"];
  one.Send(FragmentDatagram({1, 900, 299, 1, 3}, Octets(300, 1)));  // Overlap.
  one.Send(FragmentDatagram({1, 900, 0, 1, 3}, Octets(900, 1)));
  expected["packet_contradicts fragment_offset overlaps"] += 2;
  begin(2);
  for (int i = 0; i < 5; ++i) one.Send(FragmentDatagram({2, 900, 0, 0, 3}, First(300)));
  expected["packet_duplicate fragment_no"] += 5;
  // All there, and a hole.
  one.Send(FragmentDatagram({3, 900, 0, 0, 2}, First(300)));
  one.Send(FragmentDatagram({3, 900, 400, 1, 2}, Octets(500, 1)));
  ++expected["packet_contradicts fragments leave a gap"];
}

// Whole messages in every manner, of bytes that are no radar scan. @return how many.
int SendWholeJunk(Expected& expected) {
  int messages = 0;
  std::mt19937_64 rng(3);
  Attacker one, two, three;
  // Backward, and shuffled with each one twice.
  auto fragments = Fragments(10, kRadar, Pattern(5000, 1), 700);
  std::reverse(fragments.begin(), fragments.end());
  for (const Octets& fragment : fragments) one.Send(fragment);
  ++messages;
  one.Send(fragments.front());
  ++expected["packet_duplicate msg_seqno"];
  // Three senders with one number, interleaved.
  const auto a = Fragments(11, kRadar, Pattern(5000, 2), 700);
  const auto b = Fragments(11, kRadar, Pattern(5000, 3), 700);
  const auto c = Fragments(11, kRadar, Pattern(5000, 4), 700);
  for (std::size_t i = 0; i < a.size(); ++i) {
    one.Send(a[i]);
    two.Send(b[b.size() - 1 - i]);
    three.Send(c[i]);
  }
  messages += 3;
  // Two threads of one sender.
  const auto d = Fragments(12, kRadar, Pattern(5000, 5), 700);
  const auto e = Fragments(13, kRadar, Pattern(5000, 6), 700);
  for (std::size_t i = 0; i < d.size(); ++i) {
    one.Send(d[i]);
    one.Send(e[i]);
  }
  messages += 2;
  one.Send(FragmentDatagram({14, 50, 0, 0, 1}, First(50)));
  ++messages;
  return messages;
}

void SendAnnouncements(Expected& expected) {
  for (std::uint32_t i = 0; i < 50; ++i) {
    Attacker one;
    for (std::uint32_t k = 0; k < 40; ++k) {
      const std::uint32_t sequence = 10'000 + 100 * i + k;  // No port that comes again matters.
      one.Send(FragmentDatagram({sequence, 256U << 20U, 0, 0, 5000}, First(20)));
      one.Send(FragmentDatagram({sequence, 60U << 20U, 0, 0, 2000}, First(20)));
    }
  }
  expected["packet_too_large msg_size"] += 2000;
  expected[kIncomplete] += 2000;
  // One byte each, of a message of as many fragments as there can be.
  Attacker one;
  for (std::uint16_t i = 1; i < 2000; ++i) {
    one.Send(FragmentDatagram({1, 65'535, i * 2U, i, 65'535}, {7}));
  }
  ++expected[kIncomplete];
}

void SendGarbage(Expected& expected) {
  std::mt19937_64 rng(28);
  Attacker one;
  for (int i = 0; i < 2000; ++i) {
    Octets garbage(rng() % 1400);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(rng());
    one.Send(garbage);
    ++expected[garbage.size() < 8 ? "packet_malformed datagram size" : "packet_malformed magic"];
  }
}

Octets WithInt32(Octets bytes, std::size_t at, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes.at(at + i) = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * i));
  }
  return bytes;
}

// Good datagrams, hostile messages: those of the generated decoder. @return how many.
int SendHostileMessages() {
  radar_scan_t scan{};
  scan.utime = 1'700'000'000'000'000;
  scan.sensor = "FRONT";
  scan.detections.resize(2);
  scan.num_detections = 2;
  Octets good;
  wire::Encode(scan, good);
  constexpr std::size_t kName = 24;
  constexpr std::size_t kCount = kName + 4 + 6;
  std::vector<Octets> messages = {{}, Octets(4), Octets(good.begin(), good.end() - 1)};
  for (const std::int32_t count : {-1, INT32_MIN, INT32_MAX, 100'000'000, 3}) {
    messages.push_back(WithInt32(good, kCount, count));
  }
  for (const std::int32_t length : {0, -1, INT32_MIN, INT32_MAX, 5, 7}) {
    messages.push_back(WithInt32(good, kName, length));
  }
  Octets odd = good;
  odd[0] ^= 0xFF;  // Another type's fingerprint.
  messages.push_back(odd);
  odd = good;
  odd.push_back(7);
  messages.push_back(odd);
  odd = good;
  odd[kName + 4] = 'X';  // Another sensor's name inside.
  messages.push_back(odd);
  odd = good;
  odd[kName + 4 + 5] = 'X';  // A name without an end.
  messages.push_back(odd);
  messages.push_back(Octets(60'000, 0xFF));
  Attacker one;
  std::uint32_t sequence = 0;
  for (const Octets& message : messages) one.Send(ShortDatagram(++sequence, kRadar, message));
  return static_cast<int>(messages.size());
}

class LiveHostile : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr || std::getenv("V2VOUCH_BIN") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
    std::string pattern = (fs::temp_directory_path() / "live_hostile_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }
  std::unique_ptr<Program> StartDaemon(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), std::string(std::getenv("V2VOUCH_BIN")) + "/v2vouchd");
    auto daemon = std::make_unique<Program>(arguments, folder_ / "daemon.txt");
    EXPECT_TRUE(Eventually(
        [&] { return daemon->Output().find("event=started") != std::string::npos; }, 20s))
        << daemon->Output();
    return daemon;
  }
  fs::path folder_;
};

// Peak of resident memory, MB.
double PeakOf(const Program& daemon) {
  std::ifstream status("/proc/" + std::to_string(daemon.pid()) + "/status");
  for (std::string word; status >> word;) {
    if (word != "VmHWM:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1000.0;
  }
  return -1.0;
}

// Refusals on a channel, by "reason field"; incomplete messages whatever made them so.
Expected RefusalsOf(const daemon_status_t& status, const std::string& channel) {
  Expected refusals;
  for (const refusal_t& row : status.refusal_details) {
    if (row.channel != channel) continue;
    refusals[row.reason == kIncomplete ? row.reason : row.reason + " " + row.field] += row.count;
  }
  return refusals;
}

// Hears the daemon's status on a thread of its own: a flood must not fill its socket.
class StatusListener {
 public:
  StatusListener() : bus_(LcmBus::Open("")) {
    bus_->Subscribe("V2VOUCH_STATUS",
                    [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                      if (auto status = wire::Decode<daemon_status_t>(bytes)) {
                        const std::lock_guard lock(mutex_);
                        newest_ = *status;
                      }
                    });
    thread_ = std::thread([this] {
      while (!is_over_) bus_->Handle(20);
    });
  }
  ~StatusListener() {
    is_over_ = true;
    thread_.join();
  }
  [[nodiscard]] daemon_status_t newest() {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

 private:
  std::unique_ptr<LcmBus> bus_;
  std::mutex mutex_;
  daemon_status_t newest_{};
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

TEST_F(LiveHostile, EveryHostileDatagramIsCountedAndTheDriveBesideIsUntouched) {
  const std::vector<WireMessage> messages = DriveMessages(6.0);
  const std::string expected_digest = DigestOf(messages);
  const auto daemon = StartDaemon();
  const auto publisher = LcmBus::Open("");
  StatusListener listener;
  ASSERT_TRUE(publisher);
  std::thread driving([&] { Play(*publisher, messages); });
  std::this_thread::sleep_for(500ms);
  Expected expected;
  SendMalformed(expected);
  SendWrappedOffset(expected);
  SendContradictions(expected);
  const int junk = SendWholeJunk(expected);
  const int hostile = SendHostileMessages();
  SendAnnouncements(expected);
  SendGarbage(expected);
  // Past the group, to this host alone: not heard at all.
  Attacker("127.0.0.1").Send({'L', 'C', '0', '9', 0, 0, 0, 0});
  driving.join();

  EXPECT_TRUE(Eventually([&] { return RefusalsOf(listener.newest(), "(bus)") == expected; }, 15s))
      << ::testing::PrintToString(RefusalsOf(listener.newest(), "(bus)")) << "\nexpected "
      << ::testing::PrintToString(expected);
  EXPECT_TRUE(Eventually([&] { return listener.newest().digest_local == expected_digest; }, 5s));
  const daemon_status_t status = listener.newest();
  std::int64_t of_radar = 0;
  for (const auto& [what, count] : RefusalsOf(status, kRadar)) of_radar += count;
  EXPECT_EQ(of_radar, junk + hostile) << ::testing::PrintToString(RefusalsOf(status, kRadar));
  EXPECT_TRUE(daemon->IsRunning());
  EXPECT_EQ(status.kernel_drops, 0);
  EXPECT_GT(PeakOf(*daemon), 0.0);
  EXPECT_LT(PeakOf(*daemon), 200.0);
  daemon->Signal(SIGTERM);
  EXPECT_EQ(daemon->Wait(5s), 0) << daemon->Output();
  EXPECT_THAT(daemon->Output(),
              ::testing::HasSubstr("event=refused channel=(bus) reason=packet_malformed"));
}

// Which receives is chosen in the URL; data are the same.
TEST_F(LiveHostile, WithLiblcmReceivingTheDriveGivesTheSameLists) {
  const std::vector<WireMessage> messages = DriveMessages(1.5);
  const std::string url = std::string(std::getenv("LCM_DEFAULT_URL"));
  for (const std::string receiver : {"&receiver=liblcm", "&receiver=own"}) {
    const auto daemon = StartDaemon({"-l", url + receiver});
    const auto publisher = LcmBus::Open("");
    Play(*publisher, messages);
    std::this_thread::sleep_for(500ms);
    daemon->Signal(SIGTERM);
    EXPECT_EQ(daemon->Wait(5s), 0) << daemon->Output();
    EXPECT_THAT(daemon->Output(), ::testing::HasSubstr("digest_local=" + DigestOf(messages)));
  }
}

}  // namespace
}  // namespace v2vouch
