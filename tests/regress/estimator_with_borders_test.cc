// `tactus-bench frontier` took the estimator out of a fitted model and left the
// borders of its estimates in the calibration, so that no classifier could be
// made. Quick runs have too few contacts for such borders.
#include "core/classify/compiled_model.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

TEST(EstimatorWithBordersTest, IsRemovedWithThem) {
  Model model = testing::SmallModel();
  testing::AddLstms(1, model);
  model.estimator =
      RandomNetwork(2, {5}, 4, Activation::kSoftsign,
                    GateActivation::kHardSigmoid, 5, /*forget_bias=*/1,
                    /*regressions=*/2);
  model.calibration.softest.assign(model.calibration.frames.size(), 3);
  ASSERT_TRUE(CompiledModel::Create(model).ok());

  RemoveEstimator(model);
  const auto compiled = CompiledModel::Create(model);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  EXPECT_EQ((*compiled)->estimator(), nullptr);
}

}  // namespace
}  // namespace tactus::internal
