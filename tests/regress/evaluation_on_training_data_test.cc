// `evaluate --model` on the data that the model was fitted to printed 96 %
// without a word, though the bundle could have known.
#include <functional>

#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RunTrainctl;
using testing::SmallTrial;
using ::testing::StartsWith;

class EvaluationOnTrainingDataTest : public ::testing::Test {
 protected:
  // Trials number `first` to `end` - 1, as `rename` changes them.
  std::string Write(const std::string& name, int first, int end,
                    const std::function<void(Trial&)>& change = {}) {
    auto writer = TrialFileWriter::Create(folder_ / name, {});
    for (int i = first; i < end; ++i) {
      Trial trial = SmallTrial(i);
      if (change) change(trial);
      EXPECT_TRUE(writer->Append(trial).ok());
    }
    EXPECT_TRUE(writer->Close().ok());
    return folder_ / name;
  }
  std::string Run(const std::string& arguments) {
    const auto run = RunTrainctl(arguments);
    EXPECT_TRUE(run.status.ok()) << run.status;
    return run.out;
  }
  std::string Evaluate(const std::string& data, const std::string& flags = "") {
    return Run("evaluate --model=" + bundle_ + " --data=" + data + flags);
  }

  const ScratchDir folder_;
  const std::string bundle_ = folder_ / "model.tactus";
};

TEST_F(EvaluationOnTrainingDataTest, IsSaidFirstAndInJson) {
  const std::string data = Write("train.h5", 0, 12);
  Run("fit --preset=paper --networks=0 --data=" + data + " --out=" + bundle_);
  EXPECT_THAT(Evaluate(data),
              StartsWith("No test: the model was fitted to all 12 contacts"));
  const Json json = Json::parse(Evaluate(data, " --json"));
  EXPECT_EQ(json["trained_on_data"], true);
  EXPECT_EQ(json["trained_on"],
            Json({{"basis", "frames"}, {"contacts", 12}, {"tested", 12}}));
  // Neither the file nor the ids and texts of its trials make the difference.
  const std::string copy =
      Write("copy.h5", 0, 12, [](Trial& trial) { trial.id += "-copy"; });
  EXPECT_EQ(Json::parse(Evaluate(copy, " --json"))["trained_on_data"], true);
}

TEST_F(EvaluationOnTrainingDataTest, APartIsSaidToBeAPart) {
  Run("fit --preset=paper --networks=0 --data=" + Write("train.h5", 0, 12) +
      " --out=" + bundle_);
  const std::string partly = Write("partly.h5", 8, 18);
  EXPECT_THAT(Evaluate(partly), StartsWith("Partly no test: the model was "
                                           "fitted to 4 of the 10 contacts"));
  const Json json = Json::parse(Evaluate(partly, " --json"));
  EXPECT_EQ(json["trained_on_data"], true);
  EXPECT_EQ(json["trained_on"]["contacts"], 4);
}

TEST_F(EvaluationOnTrainingDataTest, OtherDataAreATest) {
  Run("fit --preset=paper --networks=0 --data=" + Write("train.h5", 0, 12) +
      " --out=" + bundle_);
  const std::string other = Write("other.h5", 12, 18);
  EXPECT_THAT(Evaluate(other), Not(HasSubstr("o test")));
  EXPECT_EQ(Json::parse(Evaluate(other, " --json"))["trained_on_data"], false);
}

}  // namespace
}  // namespace tactus::internal
