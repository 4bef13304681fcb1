#include "core/sim/exact/damped_pair.h"

#include <cmath>
#include <complex>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/core/sim/random_scenes.h"

namespace tactus::internal {
namespace {

using Root = std::complex<long double>;

// exp(a t) and (exp(a t) - exp(b t)) / (a - b) from the two roots, in long
// double: the textbook solution.
struct Textbook {
  Textbook(double p, double q) {
    const Root split = std::sqrt(Root(static_cast<long double>(p) * p / 4 - q));
    a = -static_cast<long double>(p) / 2 + split;
    b = -static_cast<long double>(p) / 2 - split;
  }
  double Value(const PairState& start, double t) const {
    const long double y = start.value;
    const long double v = start.rate;
    const long double time = t;
    const Root first = (v - b * y) / (a - b);
    const Root second = (a * y - v) / (a - b);
    return static_cast<double>(
        (first * std::exp(a * time) + second * std::exp(b * time)).real());
  }
  double Integral(const PairState& start, double t) const {
    const long double y = start.value;
    const long double v = start.rate;
    const long double time = t;
    const Root first = (v - b * y) / (a - b);
    const Root second = (a * y - v) / (a - b);
    return static_cast<double>((first * (std::exp(a * time) - 1.0L) / a +
                                second * (std::exp(b * time) - 1.0L) / b)
                                   .real());
  }
  Root a;
  Root b;
};

TEST(DampedPairTest, IsTheTextbookSolution) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double q = LogUniform(random, 1e-2, 1e12);
    const double p = 2 * std::sqrt(q) * LogUniform(random, 1e-4, 30);
    const DampedPair pair(p, q);
    const Textbook textbook(p, q);
    const double t = LogUniform(random, 1e-2, 30) / std::sqrt(q);
    const PairState start = {random.Gaussian(),
                             random.Gaussian() * std::sqrt(q)};
    const double size =
        std::abs(start.value) + std::abs(start.rate) / std::sqrt(q);
    EXPECT_NEAR(pair.After(start, t).value, textbook.Value(start, t),
                1e-13 * size)
        << p << " " << q << " " << t;
    EXPECT_NEAR(pair.Integral(start, t), textbook.Integral(start, t),
                1e-13 * size * t)
        << p << " " << q << " " << t;
    EXPECT_LE(std::abs(textbook.Value(start, t)),
              pair.Bound(start, t) * (1 + 1e-12));
  }
}

// The roots meet at p = 2 sqrt(q): y = (y0 + (v0 + y0 p / 2) t) exp(-p t / 2).
TEST(DampedPairTest, NearEqualRootsNeedNoCare) {
  for (double off : {0.0, 1e-16, -1e-16, 1e-12, -1e-12, 1e-8, -1e-8}) {
    const double decay = 20;
    const DampedPair pair(2 * decay * (1 + off), decay * decay);
    for (double t : {0.001, 0.01, 0.1, 1.0}) {
      const double want = (1 + (3 + decay) * t) * std::exp(-decay * t);
      EXPECT_NEAR(pair.After({1, 3}, t).value, want,
                  (1e-14 + 100 * std::abs(off)) * (1 + decay * t));
    }
  }
}

// The change over a short time is exact relative to the change, not only to the
// value: a bounce may rise by 1e-10 of its position.
TEST(DampedPairTest, SmallChangesKeepTheirDigits) {
  const DampedPair pair(43, 465);
  const PairState change = pair.Change({1, 0}, 1e-7);
  const double third = (43.0 * 43 - 465) * 1e-14;
  EXPECT_NEAR(change.value, -465e-14 / 2 * (1 - 43e-7 / 3 + third / 12), 1e-26);
  EXPECT_NEAR(change.rate, -465e-7 * (1 - 43e-7 / 2 + third / 6), 1e-19);
}

}  // namespace
}  // namespace tactus::internal
