#include "core/eval/fit.h"

#include "core/base/errors.h"
#include "core/bundle/model_proto.h"
#include "core/classify/compiled_model.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus {
namespace {

FitOptions QuickOptions() {
  FitOptions options = *FitPreset("tuned");
  options.states = 3;
  options.hmms_per_class = 2;
  options.max_iterations = 4;
  options.lstm.networks = 2;
  options.lstm.cells = {5};
  options.lstm.training.epochs = 2;
  return options;
}

TEST(FitModelTest, GivesACompleteModelThatPassesItsOwnWarmUp) {
  const auto contacts = testing::SyntheticContacts(8, 40, 0.1, 1);
  auto model =
      FitModel(testing::PointersTo(contacts), QuickOptions(), RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->class_names,
            (std::vector<std::string>{"HU", "HM", "SU", "SM"}));
  EXPECT_EQ(model->provenance.trials, 32u);
  EXPECT_EQ(model->calibration.frames.size(), 6u);
  EXPECT_EQ(model->calibration.lstm_weight.size(), 6u);
  EXPECT_EQ(model->lstms.size(), 2u);
  EXPECT_NE(model->lstms[0].dense_kernel, model->lstms[1].dense_kernel);
  auto compiled = CompiledModel::Create(*model);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  EXPECT_FALSE(model->warm_up.samples.empty());
  EXPECT_TRUE(RunWarmUp(**compiled).ok());
}

TEST(FitModelTest, TheSameSeedGivesTheSameBitsInAnyOrderOfWork) {
  const auto contacts = testing::SyntheticContacts(6, 30, 0.2, 2);
  const auto pointers = testing::PointersTo(contacts);
  const ParallelFor backwards = [](int count,
                                   const std::function<void(int)>& body) {
    for (int i = count; i-- > 0;) body(i);
  };
  auto a = FitModel(pointers, QuickOptions(), RunSerially);
  auto b = FitModel(pointers, QuickOptions(), backwards);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(ModelToProto(*a).SerializeAsString(),
            ModelToProto(*b).SerializeAsString());
}

TEST(FitModelTest, BadTrainingDataIsRefused) {
  const auto contacts = testing::SyntheticContacts(3, 10, 0.1, 3);
  auto reason = [](std::vector<Contact> spoilt) {
    return ReasonOf(
        FitModel(testing::PointersTo(spoilt), QuickOptions(), RunSerially)
            .status());
  };
  EXPECT_EQ(reason({}), "INVALID_TRAINING_DATA");
  auto one_class = contacts;
  for (auto& contact : one_class) contact.label = "HU";
  EXPECT_EQ(reason(one_class), "INVALID_TRAINING_DATA");
  auto lonely = contacts;
  lonely[0].label = "other";
  EXPECT_EQ(reason(lonely), "INVALID_TRAINING_DATA");
  auto rates = contacts;
  rates[0].sample_rate_hz = 50;
  EXPECT_EQ(reason(rates), "INVALID_TRAINING_DATA");
  auto skins = contacts;
  skins[0].layout = *LayoutPreset("cody-forearm");
  EXPECT_EQ(reason(skins), "INVALID_TRAINING_DATA");
}

TEST(FitPresetTest, KnowsItsNames) {
  EXPECT_EQ(FitPreset("paper")->score, Score::kViterbi);
  EXPECT_FALSE(FitPreset("paper")->log_features);
  EXPECT_EQ(FitPreset("paper")->lstm.steps.last, 1u);
  EXPECT_GT(FitPreset("tuned")->lstm.networks, 1);
  EXPECT_EQ(ReasonOf(FitPreset("magic").status()), "INVALID_CONFIG");
}

TEST(ClassNamesTest, ThePapersFourComeFirst) {
  auto contacts = testing::SyntheticContacts(1, 2, 0, 1);
  contacts[0].label = "felt";
  contacts[1].label = "cork";
  EXPECT_EQ(ClassNames(testing::PointersTo(contacts)),
            (std::vector<std::string>{"SU", "SM", "cork", "felt"}));
}

}  // namespace
}  // namespace tactus
