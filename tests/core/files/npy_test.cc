#include "core/files/npy.h"

#include <cstring>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Npy(const std::string& dictionary, const std::string& data,
                char version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += version;
  bytes += '\0';
  bytes += static_cast<char>(dictionary.size());
  bytes += '\0';
  if (version == 2) bytes += std::string(2, '\0');
  return bytes + dictionary + data;
}

constexpr char kGood[] =
    "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3), }   \n";
const std::string kData("\1\0\2\0\3\0\4\0\5\0\xFF\xFF", 12);

TEST(NpyTest, ReadsBothVersionsAndAllTypes) {
  for (const char version : {1, 2}) {
    auto array = ParseNpy("x", Npy(kGood, kData, version));
    ASSERT_TRUE(array.ok()) << array.status();
    EXPECT_THAT(array->shape, ElementsAre(2, 3));
    EXPECT_THAT(array->u16, ElementsAre(1, 2, 3, 4, 5, 65535));
  }
  const double values[] = {0.5, -1e300};
  const std::string bytes(reinterpret_cast<const char*>(values), 16);
  auto doubles = ParseNpy(
      "x", Npy("{'descr':'<f8','fortran_order':False,'shape':(2,)}\n", bytes));
  ASSERT_TRUE(doubles.ok()) << doubles.status();
  EXPECT_THAT(doubles->f64, ElementsAre(0.5, -1e300));
  auto floats = ParseNpy(
      "x", Npy("{'shape':(1,2,2),'fortran_order':False,'descr':'<f4'}", bytes));
  ASSERT_TRUE(floats.ok()) << floats.status();
  EXPECT_EQ(floats->f32.size(), 4u);
  auto bytes_as_numbers = ParseNpy(
      "x", Npy("{'descr':'|i1','fortran_order':False,'shape':(1,1,1,2)}",
               "\x7F\x80"));
  ASSERT_TRUE(bytes_as_numbers.ok()) << bytes_as_numbers.status();
  EXPECT_THAT(bytes_as_numbers->f64, ElementsAre(127, -128));
  auto empty = ParseNpy(
      "x", Npy("{'shape':(0,5),'fortran_order':False,'descr':'<f4'}", ""));
  EXPECT_TRUE(empty.ok()) << empty.status();
}

TEST(NpyTest, ReadsSingleValuesAndText) {
  const double value = 2.5;
  auto number =
      ParseNpy("x", Npy("{'descr':'<f8','fortran_order':False,'shape':()}",
                        std::string(reinterpret_cast<const char*>(&value), 8)));
  ASSERT_TRUE(number.ok()) << number.status();
  EXPECT_THAT(number->shape, ElementsAre());
  EXPECT_THAT(number->f64, ElementsAre(2.5));
  // One, two, three and four bytes of UTF-8.
  const uint32_t letters[] = {'a', 0, 0xE9, 0x20AC, 0x1F600, 0};
  auto text = ParseNpy(
      "x", Npy("{'descr':'<U2','fortran_order':False,'shape':(3,)}",
               std::string(reinterpret_cast<const char*>(letters), 24)));
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(text->text,
              ElementsAre("a", "\xC3\xA9\xE2\x82\xAC", "\xF0\x9F\x98\x80"));
  const int64_t count = -7;
  auto integer =
      ParseNpy("x", Npy("{'descr':'<i8','fortran_order':False,'shape':(1,)}",
                        std::string(reinterpret_cast<const char*>(&count), 8)));
  ASSERT_TRUE(integer.ok()) << integer.status();
  EXPECT_THAT(integer->i64, ElementsAre(-7));
}

struct BadNpy {
  const char* text;
  std::string bytes;
};

class BadNpyTest : public testing::TestWithParam<BadNpy> {};

TEST_P(BadNpyTest, IsRefused) {
  auto array = ParseNpy("a.npy", GetParam().bytes);
  EXPECT_EQ(ReasonOf(array.status()), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(array.status().message()), HasSubstr("a.npy: "));
  EXPECT_THAT(std::string(array.status().message()),
              HasSubstr(GetParam().text));
}

std::string Shape(const std::string& shape) {
  return "{'descr': '<u2', 'fortran_order': False, 'shape': " + shape + "}";
}

INSTANTIATE_TEST_SUITE_P(
    All, BadNpyTest,
    testing::Values(
        BadNpy{"not a NumPy", ""}, BadNpy{"not a NumPy", "PK\3\4"},
        BadNpy{"not a NumPy", Npy(kGood, kData).substr(0, 9)},
        BadNpy{"version 4", Npy(kGood, kData, 4)},
        BadNpy{"cut short", Npy(kGood, kData).substr(0, 30)},
        BadNpy{"understood", Npy("", kData)},
        BadNpy{"understood", Npy("{", kData)},
        BadNpy{"understood", Npy("{}", kData)},
        BadNpy{"understood", Npy(Shape("(2, 3)") + " x", kData)},
        BadNpy{"understood", Npy(Shape("(-2, 3)"), kData)},
        BadNpy{"understood", Npy(Shape("2"), kData)},
        BadNpy{"understood", Npy(Shape("(2, 3"), kData)},
        BadNpy{"understood", Npy(Shape("(99999999999, 3)"), kData)},
        BadNpy{"understood", Npy("{'descr': '<u2', 'shape': (2, 3), }", kData)},
        BadNpy{"records with named fields",
               Npy("{'descr': [('a', '<u2')], "
                   "'fortran_order': False, 'shape': (6,)}",
                   kData)},
        BadNpy{"calls for 2", Npy(Shape("()"), kData)},
        BadNpy{"5 dimensions", Npy(Shape("(1, 2, 3, 1, 1)"), kData)},
        BadNpy{"more than", Npy(Shape("(4000000000, 4000000000)"), kData)},
        // 2^62 values, whose bytes are 0 modulo 2^64.
        BadNpy{"more than", Npy(Shape("(1073741824, 4294967295)"), "")},
        BadNpy{"calls for 14", Npy(Shape("(7,)"), kData)},
        BadNpy{"calls for 10", Npy(Shape("(5,)"), kData)},
        BadNpy{"'|O', Python objects in a pickle",
               Npy("{'descr': '|O', 'fortran_order': False, "
                   "'shape': (2, 3), }",
                   kData)},
        BadNpy{"not Unicode", Npy("{'descr': '<U3', 'fortran_order': False, "
                                  "'shape': (1,), }",
                                  std::string(12, '\xFF'))},
        BadNpy{"'<U9999999'", Npy("{'descr': '<U9999999', 'fortran_order': "
                                  "False, 'shape': (1,), }",
                                  kData)},
        BadNpy{"'<c8'", Npy("{'descr': '<c8', 'fortran_order': False, "
                            "'shape': (2, 3), }",
                            kData)}));

TEST(NpyTest, NoDamageCrashes) {
  const std::string good = Npy(kGood, kData);
  Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    std::string damaged = good.substr(0, random.Index(good.size() + 1));
    for (int k = 0; k < 3 && !damaged.empty(); ++k) {
      damaged[random.Index(damaged.size())] =
          static_cast<char>(random.Index(256));
    }
    auto array = ParseNpy("x", damaged);
    if (array.ok()) {
      ASSERT_LE(array->u16.size() * 2, damaged.size());
    }
  }
}

TEST(NpyTest, AMissingFileIsAnIoError) {
  EXPECT_EQ(ReasonOf(ReadNpy("/nonexistent/a.npy").status()), "IO");
}

}  // namespace
}  // namespace tactus::internal
