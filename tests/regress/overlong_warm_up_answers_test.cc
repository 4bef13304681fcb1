// A bundle with a right checksum, more warm-up answers than classes and no
// warm-up frames was read beyond the end of a list: tactusd and trainctl
// inspect crashed.
#include <limits>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "core/bundle/model_proto.h"
#include "core/classify/compiled_model.h"
#include "gtest/gtest.h"
#include "tests/support/sealed_bundle.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

v1::ModelBundle SmallBundle() { return ModelToProto(testing::SmallModel()); }

// The reason why the bundle is not loaded, empty if it is.
std::string Load(const v1::ModelBundle& bundle) {
  const auto model =
      DecodeBundle(testing::SealedBundle(bundle.SerializeAsString()));
  if (!model.ok()) return ReasonOf(model.status());
  return ReasonOf(RunWarmUp(**model));
}

TEST(OverlongWarmUpAnswersTest, AreRefused) {
  ASSERT_EQ(Load(SmallBundle()), "");
  for (const int answers : {1, 3, 5, 6, 1000, 100'000}) {
    v1::ModelBundle bundle = SmallBundle();
    for (int i = 0; i < answers; ++i) {
      bundle.mutable_warm_up()->add_probability(0.25);
    }
    EXPECT_EQ(Load(bundle), "INVALID_MODEL") << answers;
    bundle = SmallBundle();
    for (int i = 0; i < answers; ++i) {
      bundle.mutable_warm_up()->add_log_likelihood(-1);
    }
    EXPECT_EQ(Load(bundle), "INVALID_MODEL") << answers;
  }
}

TEST(OverlongWarmUpAnswersTest, SoAreAnswersThatAreNoNumbers) {
  v1::ModelBundle bundle = SmallBundle();
  for (int k = 0; k < 4; ++k) {
    bundle.mutable_warm_up()->add_probability(
        std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(Load(bundle), "INVALID_MODEL");
}

// 64 MB of frames would take five times as much in memory, and hours to run.
TEST(OverlongWarmUpAnswersTest, SoAreEndlessTrials) {
  v1::ModelBundle bundle = SmallBundle();
  v1::WarmUpTrial& trial = *bundle.mutable_warm_up();
  for (size_t i = 0; i <= limits::kMaxWarmUpFrames; ++i) {
    for (int f = 0; f < 3; ++f) trial.add_signals(1);
    trial.add_net_force(1);
  }
  for (int k = 0; k < 4; ++k) {
    trial.add_probability(0.25);
    trial.add_log_likelihood(-1);
  }
  EXPECT_EQ(Load(bundle), "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
