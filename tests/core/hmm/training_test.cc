#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "Eigen/Eigenvalues"
#include "core/base/errors.h"
#include "core/hmm/baum_welch.h"
#include "core/hmm/expectation.h"
#include "core/hmm/init.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/forward_filter.h"

namespace tactus::internal {
namespace {

// Owns sequences and shows them as views.
struct Trials {
  std::vector<std::vector<double>> data;  // [frames x D] each
  int dimensions = 0;

  std::vector<SequenceView> views() const {
    std::vector<SequenceView> out;
    for (const std::vector<double>& x : data) {
      out.push_back(
          {x.data(), static_cast<int>(x.size()) / dimensions, dimensions});
    }
    return out;
  }
};

int Draw(const double* distribution, int count, Random& random) {
  double rest = random.Uniform();
  for (int k = 0; k < count - 1; ++k) {
    rest -= distribution[k];
    if (rest < 0) return k;
  }
  return count - 1;
}

// Sequences drawn from a model with diagonal or spherical covariances.
Trials Generate(const GaussianHmm& model, int trials, int frames,
                Random& random) {
  const int n = model.states;
  const int d = model.dimensions;
  Trials out{.data = {}, .dimensions = d};
  for (int s = 0; s < trials; ++s) {
    std::vector<double> x;
    int state = Draw(model.start.data(), n, random);
    for (int t = 0; t < frames; ++t) {
      std::vector<double> covariance(d * d);
      FullCovariance(model, state, covariance.data());
      for (int k = 0; k < d; ++k) {
        x.push_back(model.means[state * d + k] +
                    std::sqrt(covariance[k * d + k]) * random.Gaussian());
      }
      state = Draw(&model.transition[state * n], n, random);
    }
    out.data.push_back(std::move(x));
  }
  return out;
}

Trials RandomTrials(int d, Random& random) {
  Trials trials{.data = {}, .dimensions = d};
  const GaussianHmm model =
      RandomModel(5, d, CovarianceType::kFull, true, random);
  for (int s = 0; s < 8; ++s) {
    trials.data.push_back(RandomObservations(model, 20 + 9 * s, random));
  }
  return trials;
}

// For any number of lanes and any lengths.
TEST(ExpectationTest, SequencesAddUp) {
  Random random(62);
  for (const bool left_right : {false, true}) {
    const GaussianHmm model =
        RandomModel(5, 3, CovarianceType::kFull, left_right, random);
    for (const int count : {2, 3, 8, 11}) {
      std::vector<std::vector<double>> data;
      std::vector<SequenceView> views;
      for (int s = 0; s < count; ++s) {
        data.push_back(RandomObservations(model, 1 + s * 7 % 19, random));
      }
      // An outlier that no state explains.
      data[1][0] = 1e8;
      for (const std::vector<double>& x : data) {
        views.push_back({x.data(), static_cast<int>(x.size()) / 3, 3});
      }
      std::vector<double> want, got;
      const auto collect = [&model](const std::vector<SequenceView>& some,
                                    std::vector<double>& sums) {
        const ExpectedCounts from = Expectation(some).Compute(model);
        std::vector<double> all = {from.log_likelihood};
        for (const auto& part : {from.starts, from.transitions, from.occupancy,
                                 from.first_moment, from.second_moment}) {
          all.insert(all.end(), part.begin(), part.end());
        }
        sums.resize(all.size());
        for (size_t k = 0; k < all.size(); ++k) sums[k] += all[k];
      };
      collect(views, got);
      for (const SequenceView& view : views) collect({view}, want);
      for (size_t k = 0; k < want.size(); ++k) {
        EXPECT_NEAR(got[k], want[k], 1e-9 * (1 + std::abs(want[k]))) << k;
      }
    }
  }
}

// Sums over every path: the definition of what Expectation computes.
TEST(ExpectationTest, MatchesTheSumOverAllPaths) {
  Random random(61);
  for (const bool left_right : {false, true}) {
    const GaussianHmm model =
        RandomModel(3, 2, CovarianceType::kFull, left_right, random);
    const std::vector<double> x = RandomObservations(model, 6, random);
    const CompiledHmm hmm = *CompiledHmm::Create(model);
    const ExpectedCounts got = Expectation({{x.data(), 6, 2}}).Compute(model);

    std::vector<double> starts(3), transitions(9), occupancy(3), first(6),
        second(12);
    double total = 0;
    for (int code = 0; code < 729; ++code) {
      int path[6];
      for (int t = 0, rest = code; t < 6; ++t, rest /= 3) path[t] = rest % 3;
      double p = model.start[path[0]];
      std::vector<double> density(3);
      for (int t = 0; t < 6; ++t) {
        if (t > 0) p *= model.transition[path[t - 1] * 3 + path[t]];
        hmm.emissions().LogDensity(Frame(x, 2, t), density);
        p *= std::exp(density[path[t]]);
      }
      total += p;
      starts[path[0]] += p;
      for (int t = 0; t < 6; ++t) {
        const int s = path[t];
        if (t > 0) transitions[path[t - 1] * 3 + s] += p;
        occupancy[s] += p;
        for (int a = 0; a < 2; ++a) {
          const double da = x[2 * t + a] - model.means[2 * s + a];
          first[2 * s + a] += p * da;
          for (int b = 0; b <= a; ++b) {
            second[4 * s + 2 * a + b] +=
                p * da * (x[2 * t + b] - model.means[2 * s + b]);
          }
        }
      }
    }
    EXPECT_NEAR(got.log_likelihood, std::log(total), 1e-11);
    const auto expect_near = [total](const std::vector<double>& sums,
                                     const std::vector<double>& want) {
      for (size_t k = 0; k < want.size(); ++k) {
        EXPECT_NEAR(sums[k], want[k] / total,
                    1e-10 * (1 + std::abs(want[k] / total)));
      }
    };
    expect_near(got.starts, starts);
    expect_near(got.transitions, transitions);
    expect_near(got.occupancy, occupancy);
    expect_near(got.first_moment, first);
    expect_near(got.second_moment, second);
  }
}

TEST(BaumWelchTest, LikelihoodNeverFalls) {
  Random random(62);
  for (const CovarianceType type :
       {CovarianceType::kFull, CovarianceType::kDiagonal,
        CovarianceType::kSpherical}) {
    for (const int d : {1, 2, 3}) {
      for (const bool left_right : {false, true}) {
        for (const double prior : {0.0, 0.5}) {
          const Trials trials = RandomTrials(d, random);
          GaussianHmm model = *InitPaper(
              trials.views(),
              {.states = 5, .left_right = left_right, .covariance_type = type});
          const auto report = BaumWelch(trials.views(),
                                        {.max_iterations = 40,
                                         .tolerance = 0,
                                         .covariance_type = type,
                                         .left_right = left_right,
                                         .transition_prior = prior},
                                        model);
          ASSERT_TRUE(report.ok()) << report.status();
          EXPECT_TRUE(report->monotone);
          EXPECT_TRUE(Validate(model).ok());
          ASSERT_EQ(report->log_likelihood.size(), report->iterations + 1u);
          EXPECT_GT(report->log_likelihood.back(),
                    report->log_likelihood.front());
          for (int k = 1; k <= report->iterations && prior == 0; ++k) {
            const double before = report->log_likelihood[k - 1];
            EXPECT_GE(report->log_likelihood[k],
                      before - 1e-9 * std::abs(before));
          }
          // The last entry is the likelihood of the model returned.
          const CompiledHmm hmm = *CompiledHmm::Create(model);
          double sum = 0;
          for (const SequenceView& view : trials.views()) {
            ForwardFilter filter(hmm);
            for (int t = 0; t < view.frames; ++t) filter.Step(view.frame(t));
            sum += filter.log_likelihood();
          }
          EXPECT_NEAR(report->log_likelihood.back(), sum,
                      1e-10 * std::abs(sum));
        }
      }
    }
  }
}

TEST(BaumWelchTest, RecoversTheGeneratingModel) {
  Random random(63);
  GaussianHmm truth;
  truth.states = 3;
  truth.dimensions = 2;
  truth.covariance_type = CovarianceType::kDiagonal;
  truth.start = {1, 0, 0};
  truth.transition = {0.9, 0.1, 0, 0, 0.8, 0.2, 0, 0, 1};
  truth.means = {0, 0, 3, 1, 6, -2};
  truth.covariances = {0.5, 1, 1, 0.25, 0.3, 0.3};
  const Trials trials = Generate(truth, 400, 40, random);
  GaussianHmm model =
      *InitPaper(trials.views(),
                 {.states = 3, .covariance_type = CovarianceType::kDiagonal});
  const auto report = BaumWelch(trials.views(),
                                {.max_iterations = 100,
                                 .tolerance = 1e-7,
                                 .covariance_type = CovarianceType::kDiagonal},
                                model);
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(report->monotone);
  EXPECT_TRUE(report->converged);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(model.start[k], truth.start[k], 0.02);
  for (int k = 0; k < 9; ++k) {
    EXPECT_NEAR(model.transition[k], truth.transition[k], 0.02) << k;
  }
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(model.means[k], truth.means[k], 0.06) << k;
    EXPECT_NEAR(model.covariances[k], truth.covariances[k], 0.06) << k;
  }
}

TEST(BaumWelchTest, SameSeedSameBits) {
  Random random(64);
  const Trials trials = RandomTrials(3, random);
  const GaussianHmm initial = *InitPaper(trials.views(), {});
  GaussianHmm first = initial;
  GaussianHmm second = initial;
  ASSERT_TRUE(BaumWelch(trials.views(), {}, first).ok());
  ASSERT_TRUE(BaumWelch(trials.views(), {}, second).ok());
  EXPECT_EQ(first.transition, second.transition);
  EXPECT_EQ(first.means, second.means);
  EXPECT_EQ(first.covariances, second.covariances);
}

TEST(BaumWelchTest, LeftRightStaysUpperTriangular) {
  Random random(65);
  const Trials trials = RandomTrials(2, random);
  GaussianHmm model = RandomModel(4, 2, CovarianceType::kFull, false, random);
  ASSERT_TRUE(BaumWelch(trials.views(), {.left_right = true}, model).ok());
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) EXPECT_EQ(model.transition[i * 4 + j], 0);
  }
  // The last state has only a transition back. Without it, none is left.
  model.transition = {0.5, 0.5, 0,   0,   0, 0.5, 0.5, 0,
                      0,   0,   0.5, 0.5, 1, 0,   0,   0};
  const GaussianHmm before = model;
  const auto refused = BaumWelch(trials.views(), {.left_right = true}, model);
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_MODEL");
  EXPECT_EQ(model.transition, before.transition);
}

// Also where other transitions of the same length are allowed.
TEST(BaumWelchTest, ForbiddenTransitionsStayForbidden) {
  Random random(71);
  const Trials trials = RandomTrials(2, random);
  GaussianHmm model = RandomModel(5, 2, CovarianceType::kFull, false, random);
  model.transition = {0.5, 0.5, 0,   0,   0,    //
                      0,   0,   0.5, 0.5, 0,    //
                      0,   0,   0.5, 0,   0.5,  //
                      0,   0.5, 0,   0,   0.5,  //
                      0.5, 0,   0,   0,   0.5};
  const GaussianHmm initial = model;
  ASSERT_TRUE(BaumWelch(trials.views(), {.left_right = false}, model).ok());
  for (int k = 0; k < 25; ++k) {
    if (initial.transition[k] > 0) continue;
    EXPECT_EQ(model.transition[k], 0) << k;
  }
}

// A constant feature has no variance; the floor keeps the model valid.
TEST(BaumWelchTest, FloorHoldsForConstantAndLinearlyDependentFeatures) {
  Random random(66);
  Trials trials = RandomTrials(3, random);
  for (std::vector<double>& x : trials.data) {
    for (size_t k = 0; k < x.size(); k += 3) {
      x[k + 1] = 7;
      x[k + 2] = 2 * x[k];
    }
  }
  constexpr double kFloor = 1e-3;
  for (const CovarianceType type :
       {CovarianceType::kFull, CovarianceType::kDiagonal,
        CovarianceType::kSpherical}) {
    GaussianHmm model = *InitPaper(trials.views(), {.covariance_type = type});
    const auto report =
        BaumWelch(trials.views(),
                  {.covariance_floor = kFloor, .covariance_type = type}, model);
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_TRUE(report->monotone);
    for (int s = 0; s < model.states; ++s) {
      Eigen::Matrix3d covariance;
      FullCovariance(model, s, covariance.data());
      const Eigen::Vector3d values =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance)
              .eigenvalues();
      EXPECT_GE(values.minCoeff(), kFloor * (1 - 1e-9));
    }
  }
}

TEST(BaumWelchTest, DeadStatesAreGivenData) {
  Random random(67);
  const Trials trials = RandomTrials(2, random);
  for (const bool left_right : {false, true}) {
    GaussianHmm model =
        *InitPaper(trials.views(), {.states = 5, .left_right = left_right});
    model.means[4] = model.means[5] = 1e6;
    const auto report =
        BaumWelch(trials.views(),
                  {.max_iterations = 40, .left_right = left_right}, model);
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_GE(report->reseeded_states, 1);
    EXPECT_TRUE(report->monotone);
    EXPECT_LT(std::abs(model.means[4]), 100);
  }
}

TEST(BaumWelchTest, HardInputsTrain) {
  struct Case {
    const char* name;
    std::vector<std::vector<double>> data;
  };
  const Case cases[] = {
      {"one frame", {{1, 2}}},
      {"fewer frames than states", {{1, 2, 3, 4}, {1, 1}}},
      {"all frames equal", {std::vector<double>(60, 3.0)}},
      {"denormals", {std::vector<double>(60, 5e-324)}},
      {"an outlier", {{0, 0, 0, 1, 1, 0, 1e9, -1e9, 0, 1, 1, 1}}},
  };
  for (const Case& c : cases) {
    const Trials trials{c.data, 2};
    for (const bool left_right : {false, true}) {
      auto model = InitPaper(trials.views(), {.left_right = left_right});
      ASSERT_TRUE(model.ok()) << c.name << model.status();
      const auto report =
          BaumWelch(trials.views(), {.left_right = left_right}, *model);
      ASSERT_TRUE(report.ok()) << c.name << report.status();
      EXPECT_TRUE(Validate(*model).ok()) << c.name;
      EXPECT_TRUE(report->monotone) << c.name;
      EXPECT_TRUE(std::isfinite(report->log_likelihood.back())) << c.name;
    }
  }
}

TEST(BaumWelchTest, BadInputIsRefused) {
  Random random(68);
  const Trials trials = RandomTrials(2, random);
  const std::vector<SequenceView> views = trials.views();
  const GaussianHmm good = *InitPaper(views, {});
  const std::vector<double> nan = {1, std::nan("")};
  struct Case {
    const char* name;
    const char* reason;
    std::vector<SequenceView> views;
    BaumWelchOptions options;
  };
  const Case cases[] = {
      {"none", "INVALID_TRAINING_DATA", {}, {}},
      {"no frames", "INVALID_TRAINING_DATA", {{nan.data(), 0, 2}}, {}},
      {"no data", "INVALID_TRAINING_DATA", {{nullptr, 3, 2}}, {}},
      {"NaN", "INVALID_TRAINING_DATA", {{nan.data(), 1, 2}}, {}},
      {"dimensions", "INVALID_TRAINING_DATA", {{nan.data(), 1, 1}}, {}},
      {"0 dimensions", "INVALID_TRAINING_DATA", {{nan.data(), 1, 0}}, {}},
      {"mixed", "INVALID_TRAINING_DATA", {views[0], {nan.data(), 1, 1}}, {}},
      {"iterations", "INVALID_CONFIG", views, {.max_iterations = -1}},
      {"tolerance", "INVALID_CONFIG", views, {.tolerance = std::nan("")}},
      {"floor", "INVALID_CONFIG", views, {.covariance_floor = 0}},
      {"prior", "INVALID_CONFIG", views, {.transition_prior = -1}},
  };
  for (const Case& c : cases) {
    GaussianHmm model = good;
    const auto report = BaumWelch(c.views, c.options, model);
    EXPECT_EQ(ReasonOf(report.status()), c.reason) << c.name;
    EXPECT_EQ(model.means, good.means) << c.name;
  }
}

TEST(InitPaperTest, PiecesGiveMeansAndDeviations) {
  // Two pieces: 0 1 2 | 10 11 12 and 1 | 9.
  const Trials trials{{{0, 1, 2, 10, 11, 12}, {1, 9}}, 1};
  const GaussianHmm model = *InitPaper(trials.views(), {.states = 2});
  EXPECT_EQ(model.start, (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(model.means, (std::vector<double>{1, 10.5}));
  EXPECT_NEAR(model.covariances[0], 0.5, 1e-12);
  EXPECT_NEAR(model.covariances[1], 1.25, 1e-12);
  EXPECT_EQ(model.transition, (std::vector<double>{0.5, 0.5, 0, 1}));
}

TEST(InitPaperTest, TopologiesAsAsked) {
  Random random(69);
  const Trials trials = RandomTrials(2, random);
  const auto allowed = [&](InitOptions options) {
    options.states = 4;
    const GaussianHmm model = *InitPaper(trials.views(), options);
    EXPECT_TRUE(Validate(model).ok());
    std::string pattern;
    for (const double p : model.transition) pattern += p > 0 ? '1' : '0';
    return pattern;
  };
  EXPECT_EQ(allowed({}), "1100011000110001");
  EXPECT_EQ(allowed({.max_jump = 2}), "1110011100110001");
  EXPECT_EQ(allowed({.max_jump = 99}), "1111011100110001");
  EXPECT_EQ(allowed({.left_right = false}), "1111111111111111");
}

TEST(InitPaperTest, BadOptionsAreRefused) {
  Random random(70);
  const Trials trials = RandomTrials(1, random);
  for (const InitOptions& options :
       {InitOptions{.states = 0}, InitOptions{.states = 257},
        InitOptions{.max_jump = 0}, InitOptions{.covariance_floor = -1}}) {
    EXPECT_EQ(ReasonOf(InitPaper(trials.views(), options).status()),
              "INVALID_CONFIG");
  }
}

}  // namespace
}  // namespace tactus::internal
