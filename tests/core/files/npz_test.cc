#include "core/files/npz.h"

#include "absl/strings/escaping.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/files/npy_write.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Doubles(const std::vector<double>& values) {
  return NpyBytes({values.size()}, std::span<const double>(values));
}

// numpy.savez_compressed("x.npz", a=numpy.arange(3.0)) of numpy 1.24.2.
std::string CompressedByNumpy() {
  const unsigned char bytes[] = {
      0x50, 0x4b, 0x03, 0x04, 0x14, 0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x00,
      0x21, 0x00, 0x24, 0x21, 0xe1, 0x2b, 0x4c, 0x00, 0x00, 0x00, 0x98, 0x00,
      0x00, 0x00, 0x05, 0x00, 0x14, 0x00, 0x61, 0x2e, 0x6e, 0x70, 0x79, 0x01,
      0x00, 0x10, 0x00, 0x98, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x4c,
      0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x9b, 0xec, 0x17, 0xea, 0x1b,
      0x10, 0xc9, 0xc8, 0x50, 0xc6, 0x50, 0xad, 0x9e, 0x92, 0x5a, 0x9c, 0x5c,
      0xa4, 0x6e, 0xa5, 0xa0, 0x6e, 0x93, 0x66, 0xa1, 0xae, 0xa3, 0xa0, 0x9e,
      0x96, 0x5f, 0x54, 0x52, 0x94, 0x98, 0x17, 0x9f, 0x5f, 0x94, 0x92, 0x0a,
      0x12, 0x77, 0x4b, 0xcc, 0x29, 0x4e, 0x05, 0x8a, 0x17, 0x67, 0x24, 0x16,
      0xa4, 0x02, 0xf9, 0x1a, 0xc6, 0x3a, 0x9a, 0x3a, 0x0a, 0xb5, 0x0a, 0x14,
      0x00, 0x2e, 0x06, 0x14, 0xf0, 0xc1, 0x1e, 0xca, 0x70, 0x00, 0x00, 0x50,
      0x4b, 0x01, 0x02, 0x14, 0x03, 0x14, 0x00, 0x00, 0x00, 0x08, 0x00, 0x00,
      0x00, 0x21, 0x00, 0x24, 0x21, 0xe1, 0x2b, 0x4c, 0x00, 0x00, 0x00, 0x98,
      0x00, 0x00, 0x00, 0x05, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x00, 0x00, 0x00, 0x80, 0x01, 0x00, 0x00, 0x00, 0x00, 0x61, 0x2e, 0x6e,
      0x70, 0x79, 0x50, 0x4b, 0x05, 0x06, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00,
      0x01, 0x00, 0x33, 0x00, 0x00, 0x00, 0x83, 0x00, 0x00, 0x00, 0x00, 0x00,
  };
  return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}

TEST(NpzTest, WhatIsWrittenIsRead) {
  const std::vector<float> floats = {1, 2, 3, 4};
  const std::vector<uint16_t> words = {5, 65535};
  const std::string bytes = *NpzBytes(
      {{"d", Doubles({0.5, -1e300})},
       {"f", NpyBytes({2, 2}, std::span<const float>(floats))},
       {"w", NpyBytes({1, 2, 1}, std::span<const uint16_t>(words))},
       {"texts",
        NpyText({"a", "gr\xC3\xBCn \xE2\x82\xAC \xF0\x9F\x98\x80", ""})},
       {"text", NpyText("one")}});
  auto arrays = ParseNpz("x.npz", bytes);
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_EQ(arrays->size(), 5u);
  EXPECT_THAT(arrays->at("d").f64, ElementsAre(0.5, -1e300));
  EXPECT_THAT(arrays->at("f").shape, ElementsAre(2, 2));
  EXPECT_THAT(arrays->at("f").f32, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(arrays->at("w").u16, ElementsAre(5, 65535));
  EXPECT_THAT(
      arrays->at("texts").text,
      ElementsAre("a", "gr\xC3\xBCn \xE2\x82\xAC \xF0\x9F\x98\x80", ""));
  EXPECT_THAT(arrays->at("text").shape, ElementsAre());
  EXPECT_THAT(arrays->at("text").text, ElementsAre("one"));
}

TEST(NpzTest, NumpysCompressedFileIsRead) {
  auto arrays = ParseNpz("x.npz", CompressedByNumpy());
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_THAT(arrays->at("a").f64, ElementsAre(0, 1, 2));
}

TEST(NpzTest, PicklesAreRefusedByName) {
  std::string pickle = Doubles({1});
  pickle.replace(pickle.find("<f8"), 3, "|O'");
  pickle.replace(pickle.find("|O''"), 4, "|O' ");
  const auto arrays = ParseNpz("x.npz", *NpzBytes({{"model", pickle}}));
  EXPECT_EQ(ReasonOf(arrays.status()), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(arrays.status().message()),
              HasSubstr("x.npz: array model.npy: holds '|O', Python objects in "
                        "a pickle"));
}

TEST(NpzTest, WhatIsNoArrayIsRefused) {
  std::string bytes = *NpzBytes({{"a", Doubles({1})}});
  for (size_t at = bytes.find("a.npy"); at != std::string::npos;
       at = bytes.find("a.npy", at)) {
    bytes.replace(at, 5, "a.pkl");
  }
  EXPECT_THAT(std::string(ParseNpz("x.npz", bytes).status().message()),
              HasSubstr("array a.pkl: is not a .npy array"));
}

TEST(NpzTest, EveryTruncationIsRefused) {
  for (const std::string& good :
       {*NpzBytes({{"a", Doubles({1, 2, 3})}}), CompressedByNumpy()}) {
    for (size_t length = 0; length < good.size(); ++length) {
      const auto arrays = ParseNpz("x.npz", good.substr(0, length));
      ASSERT_EQ(ReasonOf(arrays.status()), "TRIAL_FILE_INVALID") << length;
      ASSERT_THAT(std::string(arrays.status().message()), HasSubstr("x.npz"));
    }
  }
}

// A changed byte of an array is seen by its CRC-32; of times, versions and
// attributes nothing depends.
TEST(NpzTest, ChangedBitsAreRefusedOrOfNoConsequence) {
  for (const std::string& good :
       {*NpzBytes({{"a", Doubles({0, 1, 2})}}), CompressedByNumpy()}) {
    for (size_t bit = 0; bit < 8 * good.size(); ++bit) {
      std::string bad = good;
      bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
      const auto arrays = ParseNpz("x.npz", bad);
      if (!arrays.ok() || !arrays->contains("a")) continue;
      ASSERT_THAT(arrays->at("a").f64, ElementsAre(0, 1, 2)) << bit;
    }
  }
}

TEST(NpzTest, SmallFilesThatClaimToBeHugeAreRefused) {
  std::string bytes = CompressedByNumpy();
  const size_t directory = bytes.rfind("PK\x01\x02");
  // The size of the array as it is unpacked: 3 GiB.
  bytes.replace(directory + 24, 4, std::string("\0\0\0\xC0", 4));
  EXPECT_EQ(ReasonOf(ParseNpz("x.npz", bytes).status()), "TRIAL_FILE_INVALID");
}

TEST(NpzTest, NoDamageCrashes) {
  const std::string good = CompressedByNumpy();
  Random random(5);
  for (int i = 0; i < 20'000; ++i) {
    std::string damaged = good;
    for (int k = 0; k < 4; ++k) {
      damaged[random.Index(damaged.size())] =
          static_cast<char>(random.Index(256));
    }
    const auto arrays = ParseNpz("x.npz", damaged);
    if (!arrays.ok()) {
      ASSERT_EQ(ReasonOf(arrays.status()), "TRIAL_FILE_INVALID");
    }
  }
}

TEST(NpzTest, FilesAreRead) {
  const ScratchDir dir;
  WriteBytes(dir / "a.npz", *NpzBytes({{"a", Doubles({7})}}));
  auto arrays = ReadNpz(dir / "a.npz");
  ASSERT_TRUE(arrays.ok()) << arrays.status();
  EXPECT_THAT(arrays->at("a").f64, ElementsAre(7));
  EXPECT_EQ(ReasonOf(ReadNpz(dir / "none.npz").status()), "IO");
}

TEST(NpzTest, ANamedArrayIsReadWhateverTheOthersHold) {
  std::string pickle = Doubles({1});
  pickle.replace(pickle.find("'<f8'"), 5, "'|O' ");
  const auto bytes = NpzBytes({{"model", pickle}, {"frames", Doubles({7})}});
  const auto frames = ParseNpz("a.npz", *bytes, "frames");
  ASSERT_TRUE(frames.ok()) << frames.status();
  EXPECT_THAT(frames->f64, ElementsAre(7));
}

// numpy.savez and numpy.savez_compressed of NumPy 1.24 for
// frames=numpy.arange(12, dtype="<i2").reshape(3, 4) - 5 and
// time=numpy.array([0, .1, .2]).
constexpr char kStored[] =
    "UEsDBBQAAAAAAAAAIQCApUcLmAAAAJgAAAAKABQAZnJhbWVzLm5weQEAEACYAAAAAAAAAJgA"
    "AAAAAAAAk05VTVBZAQB2AHsnZGVzY3InOiAnPGkyJywgJ2ZvcnRyYW5fb3JkZXInOiBGYWxz"
    "ZSwgJ3NoYXBlJzogKDMsIDQpLCB9ICAgICAgICAgICAgICAgICAgICAgICAgICAgICAgICAg"
    "ICAgICAgICAgICAgICAgICAgICAgICAgIAr7//z//f/+////AAABAAIAAwAEAAUABgBQSwME"
    "FAAAAAAAAAAhAON6lDqYAAAAmAAAAAgAFAB0aW1lLm5weQEAEACYAAAAAAAAAJgAAAAAAAAA"
    "k05VTVBZAQB2AHsnZGVzY3InOiAnPGY4JywgJ2ZvcnRyYW5fb3JkZXInOiBGYWxzZSwgJ3No"
    "YXBlJzogKDMsKSwgfSAgICAgICAgICAgICAgICAgICAgICAgICAgICAgICAgICAgICAgICAg"
    "ICAgICAgICAgICAgICAgICAgIAoAAAAAAAAAAJqZmZmZmbk/mpmZmZmZyT9QSwECFAMUAAAA"
    "AAAAACEAgKVHC5gAAACYAAAACgAAAAAAAAAAAAAAgAEAAAAAZnJhbWVzLm5weVBLAQIUAxQA"
    "AAAAAAAAIQDjepQ6mAAAAJgAAAAIAAAAAAAAAAAAAACAAdQAAAB0aW1lLm5weVBLBQYAAAAA"
    "AgACAG4AAACmAQAAAAA=";
constexpr char kDeflated[] =
    "UEsDBBQAAAAIAAAAIQCApUcLXwAAAJgAAAAKABQAZnJhbWVzLm5weQEAEACYAAAAAAAAAF8A"
    "AAAAAAAAm+wX6hsQychQxlCtnpJanFykbqWgbpNppK6joJ6WX1RSlJgXn1+UkgoSd0vMKU4F"
    "ihdnJBakAvkaxjoKJpo6CrUKZAOu3////P/7/9////8ZGBgZmBiYGVgYWBnYGABQSwMEFAAA"
    "AAgAAAAhAON6lDpQAAAAmAAAAAgAFAB0aW1lLm5weQEAEACYAAAAAAAAAFAAAAAAAAAAm+wX"
    "6hsQychQxlCtnpJanFykbqWgbpNmoa6joJ6WX1RSlJgXn1+UkgoSd0vMKU4FihdnJBakAvka"
    "xjqaOgq1ChQALgYomDUTBHbaQ+iT9gBQSwECFAMUAAAACAAAACEAgKVHC18AAACYAAAACgAA"
    "AAAAAAAAAAAAgAEAAAAAZnJhbWVzLm5weVBLAQIUAxQAAAAIAAAAIQDjepQ6UAAAAJgAAAAI"
    "AAAAAAAAAAAAAACAAZsAAAB0aW1lLm5weVBLBQYAAAAAAgACAG4AAAAlAQAAAAA=";

class NamedArrayTest : public testing::TestWithParam<const char*> {
 protected:
  NamedArrayTest() { absl::Base64Unescape(GetParam(), &bytes_); }

  std::string bytes_;
};

TEST_P(NamedArrayTest, ReadsWhatNumpyWrites) {
  const auto frames = ParseNpz("a.npz", bytes_, "frames");
  ASSERT_TRUE(frames.ok()) << frames.status();
  EXPECT_THAT(frames->shape, ElementsAre(3, 4));
  EXPECT_THAT(frames->i16,
              ElementsAre(-5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 6));
  const auto time = ParseNpz("a.npz", bytes_, "time.npy");
  ASSERT_TRUE(time.ok()) << time.status();
  EXPECT_THAT(time->f64, ElementsAre(0, 0.1, 0.2));
}

TEST_P(NamedArrayTest, NamesTheArraysThatThereAre) {
  for (const char* name : {"", "taxels"}) {
    const absl::Status status = ParseNpz("a.npz", bytes_, name).status();
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("name one of frames, time"));
  }
}

// A changed or missing byte is an error or changes nothing, never other
// numbers.
TEST_P(NamedArrayTest, DamageIsNotTakenForNumbers) {
  const auto good = ParseNpz("a.npz", bytes_, "frames")->i16;
  int refused = 0;
  for (size_t i = 0; i < bytes_.size(); ++i) {
    for (const char flip : {'\x01', '\xff'}) {
      std::string damaged = bytes_;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      const auto got = ParseNpz("a.npz", damaged, "frames");
      if (got.ok()) {
        EXPECT_EQ(got->i16, good) << i;
      } else {
        ++refused;
      }
    }
    EXPECT_FALSE(ParseNpz("a.npz", bytes_.substr(0, i), "frames").ok()) << i;
  }
  EXPECT_GT(refused, 100);
}

INSTANTIATE_TEST_SUITE_P(All, NamedArrayTest,
                         testing::Values(kStored, kDeflated));

}  // namespace
}  // namespace tactus::internal
