#include "core/hmm/gaussian_hmm.h"

#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"
#include "tests/reference/hmm/compiled_hmm.h"

namespace tactus::internal {
namespace {

GaussianHmm Good(CovarianceType type) {
  Random random(7);
  return RandomModel(3, 2, type, false, random);
}

TEST(GaussianHmmTest, GoodModelsPass) {
  for (const auto type : {CovarianceType::kFull, CovarianceType::kDiagonal,
                          CovarianceType::kSpherical}) {
    EXPECT_TRUE(Validate(Good(type)).ok());
    EXPECT_TRUE(CompiledHmm::Create(Good(type)).ok());
  }
}

TEST(GaussianHmmTest, EachFaultIsRefusedByName) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  struct Case {
    const char* what;
    void (*spoil)(GaussianHmm&);
  };
  const Case cases[] = {
      {"states", [](GaussianHmm& m) { m.states = 0; }},
      {"states", [](GaussianHmm& m) { m.states = -4; }},
      {"states", [](GaussianHmm& m) { m.states = 257; }},
      {"dimensions", [](GaussianHmm& m) { m.dimensions = 0; }},
      {"dimensions", [](GaussianHmm& m) { m.dimensions = 33; }},
      {"covariance_type",
       [](GaussianHmm& m) {
         m.covariance_type = static_cast<CovarianceType>(9);
       }},
      {"start size", [](GaussianHmm& m) { m.start.pop_back(); }},
      {"transition size", [](GaussianHmm& m) { m.transition.push_back(0); }},
      {"means size", [](GaussianHmm& m) { m.means.clear(); }},
      {"covariances size", [](GaussianHmm& m) { m.covariances.resize(3); }},
      {"covariances size",
       [](GaussianHmm& m) { m.covariance_type = CovarianceType::kDiagonal; }},
      {"start[0]", [](GaussianHmm& m) { m.start[0] = -0.1; }},
      {"start[1]", [](GaussianHmm& m) { m.start[1] = kNan; }},
      {"start[2]", [](GaussianHmm& m) { m.start[2] = 2; }},
      {"start sum", [](GaussianHmm& m) { m.start[0] *= 0.5; }},
      {"start sum", [](GaussianHmm& m) { m.start.assign(3, 0.0); }},
      {"transition[1][0]", [](GaussianHmm& m) { m.transition[3] = kInf; }},
      {"transition[2][2]", [](GaussianHmm& m) { m.transition[8] = -1e-3; }},
      {"transition[0] sum", [](GaussianHmm& m) { m.transition[0] += 1e-6; }},
      {"means[1][1]", [](GaussianHmm& m) { m.means[3] = kNan; }},
      {"covariances[2][0]", [](GaussianHmm& m) { m.covariances[8] = kInf; }},
      {"covariances[1][1][0]",
       [](GaussianHmm& m) { m.covariances[6] += 0.01; }},
      {"covariances[0]", [](GaussianHmm& m) { m.covariances[0] = -1; }},
      {"covariances[0]",
       [](GaussianHmm& m) {
         m.covariances[0] = m.covariances[1] = 1;
         m.covariances[2] = m.covariances[3] = 1;
       }},
  };
  for (const Case& c : cases) {
    GaussianHmm model = Good(CovarianceType::kFull);
    c.spoil(model);
    const absl::Status status = Validate(model);
    EXPECT_EQ(ReasonOf(status), "INVALID_MODEL") << c.what;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.what);
    EXPECT_EQ(CompiledHmm::Create(model).status().message(), status.message());
  }
}

TEST(GaussianHmmTest, VariancesMustBePositive) {
  GaussianHmm diagonal = Good(CovarianceType::kDiagonal);
  diagonal.covariances[3] = 0;
  EXPECT_EQ(InfoOf(Validate(diagonal)).metadata().at("field"),
            "covariances[1][1]");
  GaussianHmm spherical = Good(CovarianceType::kSpherical);
  spherical.covariances[2] = -1;
  EXPECT_EQ(InfoOf(Validate(spherical)).metadata().at("field"),
            "covariances[2][0]");
}

TEST(GaussianHmmTest, CovarianceTypesConvert) {
  GaussianHmm model = Good(CovarianceType::kFull);
  model.covariances = {4, 1, 1, 2, 3, 0, 0, 3, 1, 0, 0, 5};
  const GaussianHmm diagonal =
      WithCovarianceType(model, CovarianceType::kDiagonal);
  EXPECT_EQ(diagonal.covariances, (std::vector<double>{4, 2, 3, 3, 1, 5}));
  const GaussianHmm spherical =
      WithCovarianceType(model, CovarianceType::kSpherical);
  EXPECT_EQ(spherical.covariances, (std::vector<double>{3, 3, 3}));
  const GaussianHmm full = WithCovarianceType(diagonal, CovarianceType::kFull);
  EXPECT_EQ(full.covariances,
            (std::vector<double>{4, 0, 0, 2, 3, 0, 0, 3, 1, 0, 0, 5}));
}

}  // namespace
}  // namespace tactus::internal
