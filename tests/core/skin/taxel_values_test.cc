// A whole frame gives each taxel the same value as a conversion of that taxel
// alone.
#include "core/skin/taxel_values.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr float kLimit = 1e12F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The bytes of `numbers`, at an address that suits no number.
template <typename Number>
std::string Wire(const std::vector<Number>& numbers) {
  std::string wire(1 + numbers.size() * sizeof(Number), 0);
  std::memcpy(wire.data() + 1, numbers.data(), numbers.size() * sizeof(Number));
  return wire;
}

constexpr TaxelRange kRange = {0, kLimit};

template <typename Number>
constexpr v1::TaxelType TypeOf() {
  if (std::is_same_v<Number, uint16_t>) return v1::TAXEL_TYPE_UINT16;
  if (std::is_same_v<Number, int16_t>) return v1::TAXEL_TYPE_INT16;
  return v1::TAXEL_TYPE_FLOAT32;
}

template <typename Number>
void ExpectEachAsAlone(const std::vector<Number>& numbers, double scale) {
  const std::string wire = Wire(numbers);
  std::vector<float> taxels(numbers.size() + 1, -7);
  const v1::TaxelType type = TypeOf<Number>();
  EXPECT_EQ(TaxelBytes(type), sizeof(Number));
  ScaleTaxels(type, wire.data() + 1, scale,
              std::span(taxels).first(numbers.size()));
  for (size_t i = 0; i < numbers.size(); ++i) {
    const auto alone =
        static_cast<float>(static_cast<double>(numbers[i]) * scale);
    EXPECT_EQ(std::bit_cast<uint32_t>(taxels[i]),
              std::bit_cast<uint32_t>(alone))
        << i << " of " << numbers.size();
    EXPECT_EQ(std::bit_cast<uint32_t>(ScaledTaxel(
                  type, wire.data() + 1 + i * sizeof(Number), scale)),
              std::bit_cast<uint32_t>(alone));
  }
  EXPECT_TRUE(TaxelsWithin(type, wire.data() + 1, numbers.size(), scale,
                           {-kLimit, kLimit}));
  EXPECT_EQ(taxels.back(), -7) << "wrote past the end";
}

TEST(TaxelValuesTest, EveryLengthAndNumber) {
  std::mt19937 random(1);
  for (size_t count = 1; count <= 70; ++count) {
    std::vector<uint16_t> integers(count);
    std::vector<float> floats(count);
    for (size_t i = 0; i < count; ++i) {
      integers[i] = static_cast<uint16_t>(random());
      floats[i] = std::ldexp(static_cast<float>(random() % 10'000),
                             static_cast<int>(random() % 60) - 40);
    }
    ExpectEachAsAlone(integers, 0.1);
    ExpectEachAsAlone(floats, 1.0 / 3);
  }
  std::vector<uint16_t> all(65'536);
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<uint16_t>(i);
  ExpectEachAsAlone(all, 0.0123);
  ExpectEachAsAlone(std::vector<int16_t>(all.begin(), all.end()), 0.0123);
}

TEST(TaxelValuesTest, SignedValuesHaveTwoBounds) {
  for (const size_t count : {1, 7, 8, 16, 33, 384}) {
    for (size_t bad = 0; bad < count; ++bad) {
      std::vector<int16_t> numbers(count, -1000);
      const auto within = [&] {
        return TaxelsWithin(v1::TAXEL_TYPE_INT16, Wire(numbers).data() + 1,
                            count, 1, {-1000, 1000});
      };
      EXPECT_TRUE(within());
      numbers[bad] = -1001;
      EXPECT_FALSE(within()) << bad << " of " << count;
      numbers[bad] = 1001;
      EXPECT_FALSE(within()) << bad << " of " << count;
    }
  }
}

TEST(TaxelValuesTest, OtherTypesHaveNoBytes) {
  EXPECT_EQ(TaxelBytes(v1::TAXEL_TYPE_UNSPECIFIED), 0U);
  EXPECT_EQ(TaxelBytes(static_cast<v1::TaxelType>(7)), 0U);
}

TEST(TaxelValuesTest, OneBadValueAnywhereIsSeen) {
  for (const size_t count : {1, 7, 8, 16, 33, 384}) {
    for (size_t bad = 0; bad < count; ++bad) {
      for (const float value :
           {kNan, kInfinity, -kInfinity, -1e-30F, 1.1e12F}) {
        std::vector<float> numbers(count, 2.5F);
        numbers[bad] = value;
        EXPECT_FALSE(TaxelsWithin(v1::TAXEL_TYPE_FLOAT32,
                                  Wire(numbers).data() + 1, count, 1, kRange))
            << value << " at " << bad << " of " << count;
      }
    }
    EXPECT_TRUE(TaxelsWithin(v1::TAXEL_TYPE_FLOAT32,
                             Wire(std::vector<float>(count, kLimit)).data() + 1,
                             count, 1, kRange));
    for (size_t bad = 0; bad < count; ++bad) {
      std::vector<uint16_t> numbers(count, 1000);
      numbers[bad] = 1001;
      EXPECT_FALSE(TaxelsWithin(v1::TAXEL_TYPE_UINT16, Wire(numbers).data() + 1,
                                count, kLimit / 1000.0, kRange))
          << bad << " of " << count;
    }
    EXPECT_TRUE(
        TaxelsWithin(v1::TAXEL_TYPE_UINT16,
                     Wire(std::vector<uint16_t>(count, 1000)).data() + 1, count,
                     kLimit / 1000.0, kRange));
  }
}

}  // namespace
}  // namespace tactus::internal
