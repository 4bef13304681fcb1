#include "core/sim/skin/butterworth.h"

#include <cmath>
#include <numbers>

#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

// The published transfer function of a 6th-order Butterworth low-pass at 0.2
// of the Nyquist frequency (MATLAB butter(6, 0.2), scipy.signal.butter).
TEST(Butterworth6Test, MatchesThePublishedTransferFunction) {
  const double b[7] = {1, 6, 15, 20, 15, 6, 1};
  const double b0 = 0.00034054;
  const double a[7] = {1.0,        -3.5794348,  5.65866717, -4.96541523,
                       2.52949491, -0.70527411, 0.08375648};
  Butterworth6 filter(200, 2000);
  double y[60] = {};
  for (int n = 0; n < 60; ++n) {
    for (int k = 0; k <= 6 && k <= n; ++k) {
      if (n - k == 0) y[n] += b0 * b[k];
      if (k > 0) y[n] -= a[k] * y[n - k];
    }
    EXPECT_NEAR(filter.Step(n == 0 ? 1 : 0), y[n], 2e-6) << n;
  }
}

double GainAt(double frequency, double rate) {
  Butterworth6 filter(200, rate);
  double sine = 0;
  double cosine = 0;
  const int settled = static_cast<int>(rate);
  const double step = 2 * std::numbers::pi * frequency / rate;
  for (int n = 0; n < 2 * settled; ++n) {
    const double y = filter.Step(std::sin(step * n));
    if (n < settled) continue;
    sine += y * std::sin(step * n);
    cosine += y * std::cos(step * n);
  }
  return 2 * std::hypot(sine, cosine) / settled;
}

// |H|^2 = 1 / (1 + (tan(pi f / r) / tan(pi fc / r))^12).
TEST(Butterworth6Test, GainIsButterworthAtEveryRate) {
  for (double rate : {2000.0, 10000.0}) {
    for (double frequency : {10.0, 100.0, 200.0, 300.0, 466.0}) {
      const double ratio = std::tan(std::numbers::pi * frequency / rate) /
                           std::tan(std::numbers::pi * 200 / rate);
      EXPECT_NEAR(GainAt(frequency, rate),
                  1 / std::sqrt(1 + std::pow(ratio, 12)), 1e-9)
          << frequency << " Hz at " << rate;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
