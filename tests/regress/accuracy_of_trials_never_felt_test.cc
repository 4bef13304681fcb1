// "97.25 % of 1835 trials" was an accuracy over the 1,453 contacts that the
// skin felt. Accuracies state the contacts that they count.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using testing::RunTrainctl;

TEST(AccuracyOfTrialsNeverFeltTest, CountsFeltContacts) {
  const ScratchDir folder;
  const std::string data = folder / "felt.h5";
  const std::string bundle = folder / "felt.tactus";
  const auto run = [](const std::string& arguments) {
    const auto done = RunTrainctl(arguments);
    EXPECT_TRUE(done.status.ok()) << done.status;
    return done.out;
  };
  run("simulate --protocol=grid --sample=40 --skin=good --seed=3 "
      "--stiffness=543,2050 --velocity=0.02 --goal=0.019 --out=" +
      data);
  run("fit --preset=paper --networks=0 --states=3 --data=" + data +
      " --out=" + bundle);
  const std::string evaluate = "evaluate --data=" + data + " --model=" + bundle;
  const Json json = Json::parse(run(evaluate + " --json"));

  const int felt = json["felt"].get<int>();
  const int right = json["right"].get<int>();
  EXPECT_EQ(json["trials"], 40);
  ASSERT_LT(felt, 40) << "the set must hold trials that are never felt";
  EXPECT_EQ(json["undetectable"], 40 - felt);
  int answered = 0;
  int on_diagonal = 0;
  for (size_t i = 0; i < json["confusion"].size(); ++i) {
    for (const auto& count : json["confusion"][i]) answered += count.get<int>();
    on_diagonal += json["confusion"][i][i].get<int>();
  }
  EXPECT_EQ(answered, felt);
  EXPECT_EQ(on_diagonal, right);
  const double accuracy = json["accuracy"].get<double>();
  EXPECT_DOUBLE_EQ(accuracy, static_cast<double>(right) / felt);
  EXPECT_LT(json["accuracy_interval"][0].get<double>(), accuracy);
  EXPECT_GT(json["accuracy_interval"][1].get<double>(), accuracy);
  EXPECT_EQ(json["accuracy_interval_at"].size(), json["accuracy_at"].size());

  const std::string sentence = "of " + std::to_string(felt) +
                               " felt contacts; " + std::to_string(40 - felt) +
                               " of 40 were never felt";
  EXPECT_THAT(run(evaluate), HasSubstr(sentence));
}

}  // namespace
}  // namespace tactus::internal
