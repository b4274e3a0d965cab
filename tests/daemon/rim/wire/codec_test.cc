// SPDX-License-Identifier: Apache-2.0
// What one hostile packet can do to lcm-gen's decode of LCM 1.3.1 (abort, gigabytes of memory,
// over-read), and that none of it happens behind Decode.
#include "daemon/rim/wire/codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/daemon/rim/wire/allocation_watch.h"
#include "tests/daemon/rim/wire/random_message.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class T>
std::size_t MaxBytes() {
  return LayoutOf<T>().max_bytes;
}

void PutInt32(Bytes& bytes, std::size_t at, std::int32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes.at(at + i) = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) >> (24 - 8 * i));
  }
}

radar_scan_t Scan() {
  radar_scan_t scan{};
  scan.utime = 1'700'000'000'000'000;
  scan.seq = 7;
  scan.sensor = "FRONT";
  scan.detections.resize(3);
  for (auto& detection : scan.detections) detection = {10.0, 0.1, -3.0, 5.0, 20.0, -1};
  scan.num_detections = 3;
  return scan;
}

template <class T>
Bytes Encoded(const T& message) {
  Bytes bytes;
  Encode(message, bytes);
  return bytes;
}

// Where things lie in an encoded radar_scan_t: fingerprint, utime, seq, then the sensor's name.
constexpr std::size_t kNameLength = 8 + 8 + 8;
constexpr std::size_t kDetectionCount = kNameLength + 4 + 6;

TEST(Codec, RadarScanComesBackAsItWas) {
  const Bytes bytes = Encoded(Scan());
  const auto scan = Decode<radar_scan_t>(bytes);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->sensor, "FRONT");
  ASSERT_EQ(scan->detections.size(), 3u);
  EXPECT_EQ(scan->detections[2].range_rate_mps, -3.0);
  EXPECT_EQ(Encoded(*scan), bytes);
}

TEST(Codec, LengthFieldThatContradictsItsVectorStopsUs) {
  radar_scan_t scan = Scan();
  scan.num_detections = 4;  // lcm-gen would read past the end.
  Bytes bytes;
  EXPECT_DEATH(Encode(scan, bytes), "LengthsFit");
}

TEST(Codec, WrongFingerprintTruncatedAndEmptyAreRefused) {
  Bytes bytes = Encoded(Scan());
  EXPECT_EQ(Decode<radar_scan_t>(Bytes{}).reason(), Reason::kTooShort);
  EXPECT_EQ(Decode<radar_scan_t>(Bytes(bytes.begin(), bytes.begin() + 7)).reason(),
            Reason::kTooShort);
  for (std::size_t size = 8; size < bytes.size(); ++size) {
    const auto cut =
        Decode<radar_scan_t>(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(size)));
    ASSERT_FALSE(cut) << size;
    EXPECT_THAT(cut.reason(),
                testing::AnyOf(Reason::kTooShort, Reason::kBadLength, Reason::kBadString));
  }
  EXPECT_EQ(Decode<camera_detections_t>(bytes).reason(), Reason::kWrongType);
  bytes[3] ^= 1;
  EXPECT_EQ(Decode<radar_scan_t>(bytes).reason(), Reason::kWrongType);
}

TEST(Codec, TrailingBytesAreRefused) {
  Bytes bytes = Encoded(Scan());
  bytes.push_back(0);
  EXPECT_EQ(Decode<radar_scan_t>(bytes).reason(), Reason::kTrailingBytes);
}

TEST(Codec, HostileCountsAreRefusedBeforeAnythingIsAllocated) {
  for (const std::int32_t count : {-1, -2'000'000'000, 4, 1024, 1025, 100'000'000, 0x7FFFFFFF,
                                   static_cast<std::int32_t>(0x80000000)}) {
    Bytes bytes = Encoded(Scan());
    PutInt32(bytes, kDetectionCount, count);
    largest_allocation = 0;
    EXPECT_EQ(Decode<radar_scan_t>(bytes).reason(), Reason::kBadLength) << count;
    EXPECT_LT(largest_allocation.load(), 1000u) << count;
  }
  Bytes fewer = Encoded(Scan());
  PutInt32(fewer, kDetectionCount, 2);
  EXPECT_EQ(Decode<radar_scan_t>(fewer).reason(), Reason::kTrailingBytes);
}

TEST(Codec, HostileByteCountsAreRefused) {
  camera_image_t image{};
  image.sensor = "FRONT";
  image.encoding = "jpeg";
  image.data = {1, 2, 3, 4};
  image.num_bytes = 4;
  const Bytes good = Encoded(image);
  ASSERT_TRUE(Decode<camera_image_t>(good));
  for (const std::int32_t count : {-1, 5, 100'000'000, 0x7FFFFFFF}) {
    Bytes bytes = good;
    PutInt32(bytes, bytes.size() - 8, count);
    largest_allocation = 0;
    EXPECT_EQ(Decode<camera_image_t>(bytes).reason(), Reason::kBadLength) << count;
    EXPECT_LT(largest_allocation.load(), 1000u);
  }
}

TEST(Codec, HostileStringsAreRefused) {
  for (const std::int32_t length :
       {0, -1, static_cast<std::int32_t>(0x80000000), 5, 7, 300, 100'000'000, 0x7FFFFFFF}) {
    Bytes bytes = Encoded(Scan());
    PutInt32(bytes, kNameLength, length);
    largest_allocation = 0;
    EXPECT_EQ(Decode<radar_scan_t>(bytes).reason(), Reason::kBadString) << length;
    EXPECT_LT(largest_allocation.load(), 1000u);
  }
  Bytes no_nul = Encoded(Scan());
  no_nul[kNameLength + 4 + 5] = 'X';
  EXPECT_EQ(Decode<radar_scan_t>(no_nul).reason(), Reason::kBadString);
  Bytes nul_inside = Encoded(Scan());
  nul_inside[kNameLength + 4 + 2] = 0;
  EXPECT_EQ(Decode<radar_scan_t>(nul_inside).reason(), Reason::kBadString);
}

TEST(Codec, LargerThanTheTypeEverIsRefusedUnread) {
  Bytes bytes = Encoded(Scan());
  bytes.resize(MaxBytes<radar_scan_t>() + 1);
  EXPECT_EQ(Decode<radar_scan_t>(bytes).reason(), Reason::kTooLarge);
}

template <class T>
class CodecProperty : public testing::Test {};

using AllTypes =
    testing::Types<bsm_t, calibration_t, camera_detections_t, camera_image_t, daemon_status_t,
                   ego_motion_t, gnss_fix_t, misbehavior_report_t, object_list_t, obu_status_t,
                   radar_scan_t, text_t, track_list_t, truth_list_t, ego_intent_t, warning_list_t>;
TYPED_TEST_SUITE(CodecProperty, AllTypes);

TYPED_TEST(CodecProperty, WellFormedBytesComeBackBitForBit) {
  RandomMessage random(20240611);
  for (int trial = 0; trial < 50; ++trial) {
    const Bytes bytes = random.Make(LayoutOf<TypeParam>(), TypeParam::getHash());
    const auto message = Decode<TypeParam>(bytes);
    ASSERT_TRUE(message) << ReasonName(message.reason());
    EXPECT_EQ(Encoded(*message), bytes);
  }
}

// Truncations, flipped bits and 32-bit words replaced by hostile numbers: refused, or a message
// that encodes to the same bytes; never more memory than a few times the type's cap.
TYPED_TEST(CodecProperty, DamageIsRefusedOrHarmless) {
  constexpr std::array<std::int32_t, 6> kHostile = {
      -1, 0, 0x7FFFFFFF, 100'000'000, 65536, static_cast<std::int32_t>(0x80000000)};
  RandomMessage random(7);
  auto& rng = random.rng();
  largest_allocation = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Bytes bytes = random.Make(LayoutOf<TypeParam>(), TypeParam::getHash());
    switch (trial % 3) {
      case 0:
        bytes.resize(rng() % bytes.size());
        break;
      case 1:
        for (std::uint64_t flips = 1 + rng() % 8; flips > 0; --flips) {
          std::uint8_t& byte = bytes[8 + rng() % (bytes.size() - 8)];
          byte = static_cast<std::uint8_t>(byte ^ (1u << (rng() % 8)));
        }
        break;
      default:
        PutInt32(bytes, 8 + rng() % (bytes.size() - 11), kHostile[rng() % kHostile.size()]);
    }
    const auto message = Decode<TypeParam>(bytes);
    if (message) {
      EXPECT_EQ(Encoded(*message), bytes);
    }
  }
  EXPECT_LT(largest_allocation.load(), 100'000u);
}

}  // namespace
}  // namespace v2vouch::wire
