#include "core/base/sha256.h"

#include "absl/strings/escaping.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// FIPS 180-2, appendices B.1 and B.2.
TEST(Sha256Test, GivesThePublishedDigests) {
  EXPECT_EQ(absl::BytesToHexString(Sha256Of("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 hash;
  hash.Add("abcdbcdecdefdefgefghfghighijhi");
  hash.Add("");
  hash.Add("jkijkljklmklmnlmnomnopnopq");
  EXPECT_EQ(absl::BytesToHexString(hash.Finish()),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

}  // namespace
}  // namespace tactus::internal
