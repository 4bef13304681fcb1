// A bundle whose estimator has large weights put infinite deviations on the
// wire: exp of half a log-variance of 2,000.
#include <cmath>

#include "core/classify/contact_classifier.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

TEST(InfiniteObjectEstimateTest, IsLimited) {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.estimator =
      RandomNetwork(2, {5}, 4, Activation::kSoftsign,
                    GateActivation::kHardSigmoid, 5, /*forget_bias=*/1,
                    /*regressions=*/2);
  // The last two rows are the log-variances.
  for (const float log_variance : {2000.0F, -2000.0F}) {
    model.estimator->dense_bias[6] = log_variance;
    model.estimator->dense_bias[7] = log_variance;
    auto compiled = CompiledModel::Create(model);
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    ContactClassifier classifier(*compiled, {});
    for (int i = 0; i < 30; ++i) classifier.Step({{1, 1, 0.01}, 1, {}}, 0);
    ASSERT_TRUE(classifier.object());
    for (const double deviation :
         {classifier.object()->log10_stiffness_deviation,
          classifier.object()->moved_deviation_m}) {
      EXPECT_TRUE(std::isfinite(deviation)) << log_variance;
      EXPECT_GT(deviation, 0) << log_variance;
    }
  }
}

}  // namespace
}  // namespace tactus::internal
