#include "core/hmm/mixture.h"

#include <cmath>
#include <vector>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/core/hmm/random_model.h"

namespace tactus::internal {
namespace {

HmmMixture ThreeModels() {
  Random random(21);
  HmmMixture mixture;
  mixture.log_weight = {std::log(0.5), std::log(0.3), std::log(0.2)};
  for (int k = 0; k < 3; ++k) {
    mixture.components.push_back(
        RandomModel(4 + k, 2, CovarianceType::kFull, true, random));
  }
  return mixture;
}

TEST(MixtureTest, EachFaultIsRefusedByName) {
  EXPECT_TRUE(Validate(ThreeModels()).ok());
  struct Case {
    const char* what;
    void (*spoil)(HmmMixture&);
  };
  const Case cases[] = {
      {"components", [](HmmMixture& m) { m.components.clear(); }},
      {"components",
       [](HmmMixture& m) { m.components.resize(257, m.components[0]); }},
      {"log_weight size", [](HmmMixture& m) { m.log_weight.pop_back(); }},
      {"log_weight[1]", [](HmmMixture& m) { m.log_weight[1] = NAN; }},
      {"log_weight[1]", [](HmmMixture& m) { m.log_weight[1] = -INFINITY; }},
      {"log_weight[2]", [](HmmMixture& m) { m.log_weight[2] = 0.1; }},
      {"log_weight sum of exponentials",
       [](HmmMixture& m) { m.log_weight[0] -= 0.1; }},
      {"states", [](HmmMixture& m) { m.components[2].states = 0; }},
      {"components[1] dimensions",
       [](HmmMixture& m) {
         Random random(1);
         m.components[1] =
             RandomModel(2, 3, CovarianceType::kFull, true, random);
       }},
  };
  for (const Case& c : cases) {
    HmmMixture mixture = ThreeModels();
    c.spoil(mixture);
    const absl::Status status = Validate(mixture);
    EXPECT_EQ(ReasonOf(status), "INVALID_MODEL") << c.what;
    EXPECT_EQ(InfoOf(status).metadata().at("field"), c.what);
  }
}

}  // namespace
}  // namespace tactus::internal
