// SPDX-License-Identifier: Apache-2.0
// Damaged datagrams through everything that reads them: framings, envelopes, BSM, CAM, the message
// for the daemon, the writer. Each mutation lies in memory of exactly its size, so that the
// sanitizers see a read one byte too far. V2VOUCH_FUZZ_MUTATIONS sets how many (default 200000).
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <random>

#include "daemon/obu/message/bsm_message.h"
#include "daemon/obu/security/verifier.h"
#include "tests/support/obu_wrap.h"
#include "tests/support/test_authority.h"

namespace v2vouch::obu {
namespace {

struct Seed {
  Octets bytes;
  int link_type = -1;
  std::uint16_t port = 0;
};

Octets Frame(std::size_t part_two) {
  Bsm bsm;
  bsm.core.id = 0x12345678;
  const Octets content(part_two, 0x14);
  if (part_two > 0) {
    bsm.part_two[0] = {0, {content, 0, part_two * 8}};
    bsm.part_two[1] = {2, {content, 0, part_two * 8}};
    bsm.part_two_count = 2;
  }
  Octets bytes(2304);
  std::size_t size = 0;
  EXPECT_FALSE(WriteBsmFrame(bsm, bytes, size));
  bytes.resize(size);
  return bytes;
}

// Every framing of a frame.
void AddFramings(const Octets& frame, std::vector<Seed>& seeds) {
  const TestCertificate root = RootCertificate({.name = "root", .may_issue = true});
  const TestCertificate car = ImplicitCertificate(root, {.name = "car"});
  for (const Octets& inside :
       {frame, WrapUnsecured(frame), WrapSigned(frame), SignedBy(car, frame, 700000000000000, true),
        SignedBy(root, frame, 700000000000000, true)}) {
    const Octets wsmp = WrapWsmp(inside);
    const Octets wlan = WrapWlan(WrapLlc(wsmp));
    for (const Octets& bytes :
         {inside, wsmp, WrapWsmpWithOptions(inside), WrapCv2x(wsmp), WrapEthernet(wsmp),
          WrapLlc(wsmp), wlan, WrapRadiotap(wlan, -70), WrapC2p(wlan, 0x01), WrapC2p(wlan, 0x12)}) {
      seeds.push_back({bytes});
    }
    seeds.push_back({WrapC2pCv2x(wsmp, -70), -1, kPortC2p});
    seeds.push_back({RsuText(inside)});
    seeds.push_back({HexText(wsmp, true)});
    seeds.push_back({WrapEthernet(wsmp), 1});
    seeds.push_back({WrapRadiotap(wlan, -70), 127});
    seeds.push_back({wlan, 105});
    seeds.push_back({WrapEthernet(WrapUdp(wsmp, 5398), 0x0800), 1});
    seeds.push_back({WrapUdp(wsmp, 5398, true), 101});
    seeds.push_back({Joined(Octets(16), WrapUdp(wsmp, 5398)), 113});
  }
}

std::vector<Seed> Seeds() {
  std::vector<Seed> seeds;
  AddFramings(Frame(0), seeds);
  AddFramings(Frame(60), seeds);
  if (HasObuData()) {
    for (const BsmVector& vector : BsmVectors()) seeds.push_back({vector.bytes});
    for (const UnitRecord& record : UnitRecords()) seeds.push_back({record.bytes});
    for (const char* name : {"ieee1609/gdot.hex", "ieee1609/udp.hex", "ieee1609/udp2.hex",
                             "etsi/cam_long.uper.hex", "etsi/cam_radiotap_frame.hex"}) {
      const Octets text = ObuFile(name);
      const Octets bytes = FromHex(std::string(text.begin(), text.end()));
      seeds.push_back({bytes});
      if (std::string(name).starts_with("etsi/cam_long")) {
        seeds.push_back({WrapBtp(bytes)});
        seeds.push_back({WrapCohda(bytes)});
        seeds.push_back({WrapGeo(WrapBtp(bytes))});
        seeds.push_back({WrapEthernet(WrapGeo(WrapBtp(bytes)), 0x8947), 1});
      }
    }
  }
  return seeds;
}

Octets Mutated(Octets bytes, const std::vector<Seed>& seeds, std::mt19937_64& rng) {
  const auto place = [&] { return bytes.empty() ? 0 : rng() % bytes.size(); };
  for (std::uint64_t times = 1 + rng() % 3; times > 0; --times) {
    if (bytes.empty()) return bytes;
    switch (rng() % 8) {
      case 0:
        bytes.resize(rng() % bytes.size());
        break;
      case 1:
        bytes[place()] ^= static_cast<std::uint8_t>(1U << rng() % 8);
        break;
      case 2:
        bytes[place()] = static_cast<std::uint8_t>(rng());
        break;
      case 3: {  // Lengths and choices.
        static constexpr std::uint8_t kOdd[] = {0x00, 0x7F, 0x80, 0x81, 0x84, 0xC1, 0xFF, 0x14};
        bytes[place()] = kOdd[rng() % 8];
        break;
      }
      case 4:
        bytes[rng() % std::min<std::size_t>(bytes.size(), 32)] ^= static_cast<std::uint8_t>(rng());
        break;
      case 5: {
        const Octets more(rng() % 40, static_cast<std::uint8_t>(rng()));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place()), more.begin(),
                     more.end());
        break;
      }
      case 6: {
        const auto at = static_cast<std::ptrdiff_t>(place());
        bytes.erase(
            bytes.begin() + at,
            bytes.begin() + std::min<std::ptrdiff_t>(at + static_cast<std::ptrdiff_t>(rng() % 20),
                                                     static_cast<std::ptrdiff_t>(bytes.size())));
        break;
      }
      default: {  // The end of another one.
        const Octets& other = seeds[rng() % seeds.size()].bytes;
        const std::size_t from = rng() % (other.size() + 1);
        bytes.resize(place());
        bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
      }
    }
  }
  return bytes;
}

// What every reader promises of any bytes.
struct Outcome {
  bool has_message = false;
};
Outcome Swallow(const Octets& bytes, const Seed& seed, Verifier& verifier, std::int64_t utime) {
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  const Bytes view(exact.get(), bytes.size());
  std::array<std::uint8_t, kLongestDatagram> scratch{};
  Datagram datagram;
  const DatagramOptions options{std::nullopt, true, seed.port};
  if (seed.link_type < 0) {
    ReadDatagram(view, options, scratch, datagram);
  } else {
    ReadPacket(seed.link_type, view, options, scratch, datagram);
  }
  EXPECT_TRUE(datagram.fault || datagram.bsm || datagram.cam);
  if (datagram.dot2) verifier.Judge(*datagram.dot2, utime);
  if (!datagram.fault) {
    const bsm_t message = BsmMessage(datagram, {utime, 1, {}, 0});
    EXPECT_GE(message.lat, -900000000);
    EXPECT_LE(message.lat, 900000001);
    EXPECT_GE(message.speed, 0);
    EXPECT_LE(message.heading, 28800);
  }
  if (datagram.bsm) {
    std::array<std::uint8_t, kLongestDatagram> out{};
    std::size_t size = 0;
    EXPECT_FALSE(WriteBsmFrame(*datagram.bsm, out, size));
    Bsm again;
    EXPECT_FALSE(ReadBsmFrame(std::span(out).first(size), again));
    EXPECT_EQ(again.core, datagram.bsm->core);
  }
  return {!datagram.fault};
}

TEST(ObuFuzz, MutatedDatagramsEndAsAMessageOrAFault) {
  const std::vector<Seed> seeds = Seeds();
  const char* const wanted = std::getenv("V2VOUCH_FUZZ_MUTATIONS");
  const std::int64_t mutations = wanted != nullptr ? std::atoll(wanted) : 200000;
  std::mt19937_64 rng(1609);
  Verifier verifier({.most_certificates = 64, .checks_per_s = 100}, {});
  std::int64_t messages = 0;
  for (std::int64_t i = 0; i < mutations; ++i) {
    const Seed& seed = seeds[rng() % seeds.size()];
    const Octets bytes = Mutated(seed.bytes, seeds, rng);
    messages += Swallow(bytes, seed, verifier, 1700000000000000 + i * 100).has_message ? 1 : 0;
    if (testing::Test::HasFailure()) {
      FAIL() << "mutation " << i << ": " << HexText(bytes);
    }
  }
  RecordProperty("messages", std::to_string(messages));
  EXPECT_GT(messages, mutations / 20);  // Not all are thrown out at the door.
}

TEST(ObuFuzz, EveryPrefixOfEverySeedEndsAsAMessageOrAFault) {
  const std::vector<Seed> seeds = Seeds();
  Verifier verifier({.checks_per_s = 0}, {});
  for (const Seed& seed : seeds) {
    for (std::size_t size = 0; size < seed.bytes.size(); ++size) {
      const Octets prefix(seed.bytes.begin(),
                          seed.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      Swallow(prefix, seed, verifier, 1700000000000000);
    }
  }
}

TEST(ObuFuzz, NoiseEndsAsAFault) {
  std::mt19937_64 rng(1);
  Verifier verifier({.checks_per_s = 100}, {});
  std::int64_t messages = 0;
  for (int i = 0; i < 20000; ++i) {
    Octets bytes(rng() % 400);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(rng());
    messages += Swallow(bytes, {{}, i % 3 == 0 ? 1 : -1}, verifier, 1).has_message ? 1 : 0;
  }
  EXPECT_EQ(messages, 0);
}

}  // namespace
}  // namespace v2vouch::obu
