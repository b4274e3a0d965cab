// SPDX-License-Identifier: Apache-2.0
#include "daemon/base/sha256.h"

#include <gtest/gtest.h>

#include <string_view>

namespace v2vouch {
namespace {

std::string Digest(std::string_view text, Sha256::Rounds rounds = Sha256::Rounds::kFastest) {
  Sha256 digest(rounds);
  digest.Add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  return digest.Hex();
}

// Test vectors of NIST for FIPS 180-4 (SHA-256 examples and the empty message).
TEST(Sha256, AgreesWithTheStandardsVectors) {
  for (const auto rounds : {Sha256::Rounds::kFastest, Sha256::Rounds::kPlain}) {
    EXPECT_EQ(Digest("", rounds),
              "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(Digest("abc", rounds),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(Digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", rounds),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(Digest(std::string(1'000'000, 'a'), rounds),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  }
}

// On a processor without the extensions both are the plain rounds.
TEST(Sha256, TheProcessorsRoundsGiveTheSameAsThePlainOnes) {
  std::string text;
  for (int i = 0; i < 500; ++i) {
    EXPECT_EQ(Digest(text), Digest(text, Sha256::Rounds::kPlain)) << i;
    text += static_cast<char>(i * i % 251);
  }
}

TEST(Sha256, PiecesGiveTheSameAsTheWholeAndReadingDoesNotDisturb) {
  const std::string text(300, 'q');
  Sha256 pieces;
  for (const char c : text) {
    const auto byte = static_cast<std::uint8_t>(c);
    pieces.Add({&byte, 1});
    static_cast<void>(pieces.Hex());
  }
  EXPECT_EQ(pieces.Hex(), Digest(text));
}

}  // namespace
}  // namespace v2vouch
