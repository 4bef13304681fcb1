#include "core/sim/skin/taxel_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/for_each_target.h"

namespace tactus::internal {
namespace {

// Lengths that are no multiple of a vector's.
constexpr size_t kLengths[] = {1, 7, 8, 9, 384, 389};

std::vector<double> Uniform(Random& random, size_t count, double high) {
  std::vector<double> numbers(count);
  for (double& number : numbers) number = random.Uniform(0, high);
  return numbers;
}

TEST(TaxelKernelsTest, ReadsWhatOneTaxelAtATimeReads) {
  ForEachTarget([] {
    Random random(1);
    const taxel_kernels::Electronics by = {
        .noise_n = 0.3, .lagging = 0.15, .follow = 0.02};
    for (const size_t count : kLengths) {
      const std::vector<double> forces = Uniform(random, count, 1);
      const std::vector<double> offset = Uniform(random, count, 0.1);
      std::vector<double> deviates = Uniform(random, count, 3);
      for (double& deviate : deviates) deviate -= 1.5;
      std::vector<double> alive(count, 1);
      alive[count / 2] = 0;
      std::vector<double> lagging = Uniform(random, count, 1);
      std::vector<double> expected_lagging = lagging;
      std::vector<double> readings(count);
      taxel_kernels::Read(forces, by,
                          {.alive = alive.data(),
                           .offset = offset.data(),
                           .deviates = deviates.data(),
                           .lagging = lagging.data()},
                          readings.data());
      for (size_t i = 0; i < count; ++i) {
        double& late = expected_lagging[i];
        late += by.follow * (forces[i] - late);
        const double reading = (1 - by.lagging) * forces[i] +
                               by.lagging * late + offset[i] +
                               by.noise_n * deviates[i];
        EXPECT_EQ(lagging[i], late);
        EXPECT_EQ(readings[i], alive[i] > 0 ? std::max(0.0, reading) : 0);
      }
    }
  });
}

// As std::round() and std::min() do, most of all next to a half.
TEST(TaxelKernelsTest, QuantisesByRoundingHalvesUp) {
  ForEachTarget([] {
    constexpr double kMost = std::numeric_limits<uint16_t>::max();
    Random random(2);
    for (const double step : {1.0, 0.001, 0.002}) {
      std::vector<double> readings = {0, 1e-300, 1e6, 1e300};
      for (int i = 0; i <= kMost; ++i) {
        const double half = (i + 0.5) * step;
        readings.insert(readings.end(), {half, std::nextafter(half, 0),
                                         std::nextafter(half, 1e9), i * step});
      }
      const std::vector<double> more = Uniform(random, 10'001, 70'000 * step);
      readings.insert(readings.end(), more.begin(), more.end());
      std::vector<uint16_t> steps(readings.size());
      taxel_kernels::Quantise(readings, step, steps.data());
      for (size_t i = 0; i < readings.size(); ++i) {
        ASSERT_EQ(steps[i], std::min(std::round(readings[i] / step), kMost))
            << readings[i] << " by " << step;
      }
    }
  });
}

}  // namespace
}  // namespace tactus::internal
