// `trainctl evaluate` used the HMMs alone by default, even with a bundle that
// has LSTMs: it reported 88.1 % where the served answers had 93.1 %. With
// --algorithm=fused and no LSTM it reported fused answers.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using testing::RunTrainctl;

class EvaluationOfHalfABundleTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Run("simulate --protocol=grid --sample=24 --stiffness=543,2050 "
        "--velocity=0.02 --goal=0.019 --out=" +
        data_);
  }

  std::string Run(const std::string& arguments) {
    const auto run = RunTrainctl(arguments);
    EXPECT_TRUE(run.status.ok()) << run.status;
    return run.out;
  }
  std::string Fit(const std::string& flags) {
    const std::string bundle = folder_ / "half.tactus";
    Run("fit --data=" + data_ + " --out=" + bundle +
        " --preset=paper --states=3 " + flags);
    return bundle;
  }
  Json Evaluate(const std::string& flags) {
    Json json = Json::parse(Run("evaluate --json --data=" + data_ + flags));
    json.erase("seconds");
    return json;
  }

  const ScratchDir folder_;
  const std::string data_ = folder_ / "half.h5";
};

TEST_F(EvaluationOfHalfABundleTest, LstmsTakePartUnlessHmmsAreChosen) {
  const std::string model = " --model=" + Fit("--networks=1 --epochs=1");
  const Json served = Evaluate(model);
  EXPECT_EQ(served["algorithm"], "fused");
  EXPECT_EQ(served, Evaluate(model + " --algorithm=fused"));
  EXPECT_EQ(Evaluate(model + " --algorithm=hmm")["algorithm"], "hmm");
}

TEST_F(EvaluationOfHalfABundleTest, NothingIsFusedWithoutLstms) {
  const std::string model = " --model=" + Fit("--networks=0");
  EXPECT_EQ(Evaluate(model)["algorithm"], "hmm");
  EXPECT_EQ(Evaluate(model + " --algorithm=fused")["algorithm"], "hmm");
  EXPECT_THAT(Run("evaluate --algorithm=fused --data=" + data_ + model),
              HasSubstr("hmm (there is no LSTM to fuse)"));
}

}  // namespace
}  // namespace tactus::internal
