// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/sha256.h"

#include <gtest/gtest.h>

#include <string_view>

namespace v2vouch {
namespace {

std::string Digest(std::string_view text) {
  Sha256 digest;
  digest.Add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  return digest.Hex();
}

// Test vectors of NIST for FIPS 180-4 (SHA-256 examples and the empty message).
TEST(Sha256, AgreesWithTheStandardsVectors) {
  EXPECT_EQ(Digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(Digest(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
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

// A running digest is copied with its state, as a checkpoint is.
TEST(Sha256, CopiesGoOnByThemselves) {
  Sha256 first;
  const std::uint8_t a = 'a', b = 'b', c = 'c';
  first.Add({&a, 1});
  Sha256 copy = first;
  first.Add({&b, 1});
  first.Add({&c, 1});
  EXPECT_EQ(copy.Hex(), Digest("a"));
  copy = first;
  first.Add({&c, 1});
  EXPECT_EQ(copy.Hex(), Digest("abc"));
  EXPECT_EQ(first.Hex(), Digest("abcc"));
}

}  // namespace
}  // namespace v2vouch
