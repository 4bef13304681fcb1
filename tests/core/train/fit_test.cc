#include "core/train/fit.h"

#include <algorithm>
#include <functional>

#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/bundle/model_proto.h"
#include "core/classify/compiled_model.h"
#include "core/contacts/folds.h"
#include "core/eval/evaluate.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
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

// The calibration comes from contacts that the model has not seen.
TEST(FitModelTest, HeldOutContactsAreNotFittedTo) {
  const auto contacts = testing::SyntheticContacts(20, 40, 0.1, 1);
  FitOptions options = QuickOptions();
  options.held_out = 0.25;
  const auto model =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  std::vector<const LabelledContact*> rest;
  const auto all = testing::PointersTo(contacts);
  for (const int i : Complement(StratifiedFolds(all, 4).front(), 80)) {
    rest.push_back(all[i]);
  }
  ASSERT_EQ(rest.size(), 60u);
  options.held_out = 0;
  options.calibrate = false;
  const auto alone = FitModel(rest, options, RunSerially);
  ASSERT_TRUE(alone.ok());
  EXPECT_EQ(model->hmms[0].components[0].means,
            alone->hmms[0].components[0].means);
  EXPECT_EQ(model->lstms[0].dense_kernel, alone->lstms[0].dense_kernel);
  EXPECT_EQ(model->calibration.frames.size(), 6u);
}

TEST(FitModelTest, ContactsWithAndWithoutPosesAreNotMixed) {
  auto contacts = testing::SyntheticContacts(8, 40, 0.1, 1);
  FitOptions options = QuickOptions();
  options.lstm.networks = 0;
  const auto fit = [&] {
    return FitModel(testing::PointersTo(contacts), options, RunSerially);
  };
  EXPECT_EQ(fit()->poses, PoseNeed::kNeeded);
  contacts[3].with_poses = false;
  EXPECT_EQ(ReasonOf(fit().status()), "INVALID_TRAINING_DATA");
  for (LabelledContact& contact : contacts) contact.with_poses = false;
  EXPECT_EQ(fit()->poses, PoseNeed::kIgnored);
  // Without the motion poses do not matter.
  contacts[3].with_poses = true;
  options.features = {Feature::kForce, Feature::kArea};
  EXPECT_EQ(fit()->poses, PoseNeed::kEither);
}

// An object that moves late is unmoved at first.
TEST(FitModelTest, AModelOfTheCategorySoFarFollowsTheMotion) {
  auto contacts = testing::SyntheticContacts(60, 60, 0.1, 1);
  for (LabelledContact& contact : contacts) {
    const std::vector<double> rest(30, 0.0);
    contact.object_motion = rest;
    contact.object_motion.resize(60, contact.label[1] == 'M' ? 0.01 : 0.0);
    // Until then it looks like one that never moves.
    const LabelledContact& unmoved = contacts[std::stoi(contact.id) / 2 * 2];
    for (size_t t = 0; t < 30; ++t) {
      contact.frames.Set(t, unmoved.frames[t]);
    }
  }
  FitOptions options = QuickOptions();
  options.truth = Truth::kSoFar;
  options.lstm.training.epochs = 20;
  options.calibrate = false;
  const auto model =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_EQ(model->truth, Truth::kSoFar);
  const auto result = EvaluateModel(*CompiledModel::Create(*model),
                                    testing::PointersTo(contacts),
                                    Algorithm::kLstm, RunSerially);
  ASSERT_TRUE(result.ok()) << result.status();
  // 0.25 s: before the motion; the last: after it.
  int early = 0;
  int late = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    early += result->anytime[1][i].answer() == result->so_far[1][i];
    late += result->final[i].answer() == result->final[i].label;
    EXPECT_EQ(result->so_far[1][i] % 2, 0);
  }
  EXPECT_GT(early, 200);
  EXPECT_GT(late, 200);
}

TEST(FitModelTest, EstimatesTheObjectWhereTheTruthIsKnown) {
  auto contacts = testing::SyntheticContacts(8, 40, 0.1, 1);
  FitOptions options = QuickOptions();
  options.lstm.training.epochs = 30;
  // Other stiffnesses also need the truth, which these contacts lack.
  options.variations.stiffness = 1;
  const auto without =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_FALSE(without->estimator.has_value());
  for (LabelledContact& contact : contacts) {
    contact.stiffness = contact.label[0] == 'H' ? 1e6 : 1e3;
    contact.object_motion.assign(contact.frames.size(), 0.0);
  }
  const auto pointers = testing::PointersTo(contacts);
  auto model = FitModel(pointers, options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  ASSERT_TRUE(model->estimator.has_value());
  // The estimator takes nothing from the networks that classify.
  EXPECT_EQ(model->lstms[0].dense_kernel, without->lstms[0].dense_kernel);
  const auto result = EvaluateModel(*CompiledModel::Create(*model), pointers,
                                    Algorithm::kFused, RunSerially);
  ASSERT_TRUE(result.ok()) << result.status();
  double hard = 0;
  double soft = 0;
  for (const auto& estimate : result->final_estimates) {
    ASSERT_TRUE(estimate.has_value());
    EXPECT_GT(estimate->estimate.log10_stiffness_deviation, 0);
    (estimate->log10_stiffness > 5 ? hard : soft) +=
        estimate->estimate.log10_stiffness / 16;
  }
  EXPECT_GT(hard, soft + 1);
}

// Two conditions of `per_class` contacts of each class; every one states its
// stiffness if `known` says so of its condition.
std::vector<LabelledContact> KnownWhere(
    int per_class, const std::function<bool(absl::string_view)>& known) {
  auto contacts = testing::SyntheticContacts(per_class, 40, 0.1, 1);
  for (LabelledContact& contact : contacts) {
    if (!known(contact.condition)) continue;
    contact.stiffness = contact.label[0] == 'H' ? 1e6 : 1e3;
    contact.object_motion.assign(contact.frames.size(), 0.0);
  }
  return contacts;
}

TEST(FitModelTest, KnowsTheSoftestObject) {
  const auto contacts = KnownWhere(40, [](auto) { return true; });
  FitOptions options = QuickOptions();
  options.variations.copies = 0;
  options.lstm.training.epochs = 30;
  options.held_out = 0.5;
  const auto model =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  ASSERT_EQ(model->calibration.softest.size(), 6u);
  // Half of the objects have 1e3 N/m.
  EXPECT_NEAR(model->calibration.softest.back(), 3, 1);
}

// A fold of contacts with a known stiffness has an estimator, the model of all
// contacts has none.
TEST(FitModelTest, WithoutAnEstimatorNoObjectIsTooSoft) {
  const auto contacts = KnownWhere(
      40, [](absl::string_view condition) { return condition == "slow"; });
  FitOptions options = QuickOptions();
  options.variations = {.copies = 0, .stiffness = 1};
  for (const char* left_out : {"slow", "fast"}) {
    auto sorted = testing::PointersTo(contacts);
    // The first fold leaves the condition out that comes first.
    std::stable_partition(sorted.begin(), sorted.end(),
                          [&](const LabelledContact* contact) {
                            return contact->condition == left_out;
                          });
    const auto model = FitModel(sorted, options, RunSerially);
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_FALSE(model->estimator.has_value());
    EXPECT_TRUE(model->calibration.softest.empty());
  }
}

TEST(FitModelTest, LstmsAloneLearnOtherStiffnesses) {
  auto contacts = testing::SyntheticContacts(8, 40, 0.1, 1);
  for (LabelledContact& contact : contacts) {
    contact.stiffness = contact.label[0] == 'H' ? 1e6 : 1e3;
  }
  FitOptions options = QuickOptions();
  options.calibrate = false;
  const auto pointers = testing::PointersTo(contacts);
  const auto with = FitModel(pointers, options, RunSerially);
  options.variations.stiffness = 1;
  const auto without = FitModel(pointers, options, RunSerially);
  ASSERT_TRUE(with.ok() && without.ok());
  EXPECT_EQ(with->warm_up.log_likelihood, without->warm_up.log_likelihood);
  EXPECT_NE(with->lstms[0].dense_kernel, without->lstms[0].dense_kernel);
}

// How many inner folds a calibration for new materials takes.
int InnerFoldsOf(int materials) {
  auto contacts = testing::SyntheticContacts(2 * materials, 20, 0.1, 1);
  for (size_t i = 0; i < contacts.size(); ++i) {
    contacts[i].material = std::to_string(static_cast<int>(i) / 4 % materials);
  }
  FitOptions options = QuickOptions();
  options.lstm.networks = 0;
  options.variations.copies = 0;
  options.inner_folds = InnerFolds::kMaterials;
  // Counts the folds that were scored.
  struct Count : FitJournal {
    void OnPoint(const LearningPoint& point) override {
      folds += point.validation_accuracy.has_value();
    }
    int folds = 0;
  } count;
  const auto model =
      FitModel(testing::PointersTo(contacts), options, RunSerially, {}, &count);
  EXPECT_TRUE(model.ok()) << model.status();
  return count.folds;
}

TEST(FitModelTest, InnerFoldsLeaveFewMaterialsOutTogether) {
  EXPECT_EQ(InnerFoldsOf(2), 2);
  EXPECT_EQ(InnerFoldsOf(3), 3);
  EXPECT_EQ(InnerFoldsOf(12), 6);
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

TEST(FitModelTest, StartLendsItsThreadsUntilTheFirstIteration) {
  const auto contacts = testing::SyntheticContacts(6, 30, 0.2, 2);
  const auto pointers = testing::PointersTo(contacts);
  FitOptions options = QuickOptions();
  options.variations.copies = 2;
  struct Points : FitJournal {
    int count = 0;
    void OnPoint(const LearningPoint&) override { ++count; }
  } points;
  int lent = 0;
  const ParallelFor start = [&](int count,
                                const std::function<void(int)>& body) {
    EXPECT_EQ(points.count, 0);
    lent += count;
    for (int i = count; i-- > 0;) body(i);
  };
  auto a = FitModel(pointers, options, RunSerially, {}, &points, start);
  auto b = FitModel(pointers, options, RunSerially);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_GT(lent, 0);
  EXPECT_GT(points.count, 0);
  EXPECT_EQ(ModelToProto(*a).SerializeAsString(),
            ModelToProto(*b).SerializeAsString());
}

TEST(FitModelTest, BadTrainingDataIsRefused) {
  const auto contacts = testing::SyntheticContacts(3, 10, 0.1, 3);
  auto reason = [](std::vector<LabelledContact> spoilt) {
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

// Classes that differ in nothing but the half of the skin they load.
std::vector<LabelledContact> ContactsByPlace() {
  auto contacts = testing::SyntheticContacts(6, 12, 0.1, 4);
  Random random(4);
  for (auto& contact : contacts) {
    contact.layout = *LayoutPreset("icub-6x10");
    const bool hard = contact.label[0] == 'H';
    contact.label = hard ? "near" : "far";
    for (size_t t = 0; t < contact.frames.size(); ++t) {
      ContactFrame frame = {IdealSample({1, 1e-4, 0.001})};
      frame.sample.profile[hard ? 0 : 15] = 3 + 0.1 * random.Gaussian();
      contact.frames.Set(t, frame);
    }
  }
  return contacts;
}

TEST(FitModelTest, ThePresetProfileDistinguishesPlaces) {
  const auto contacts = ContactsByPlace();
  auto model = FitModel(testing::PointersTo(contacts), *FitPreset("profile"),
                        RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_TRUE(model->lstms.empty());
  // Through the file's form, which must keep what the warm-up needs.
  auto back = ModelFromProto(ModelToProto(*model));
  ASSERT_TRUE(back.ok()) << back.status();
  auto compiled = CompiledModel::Create(*back);
  ASSERT_TRUE(compiled.ok()) << compiled.status();
  EXPECT_TRUE(RunWarmUp(**compiled).ok());
  for (const LabelledContact& contact : contacts) {
    ContactClassifier classifier(*compiled, {});
    for (const auto& frame : contact.frames) classifier.StepOrHold(frame, 0);
    const int label = contact.label == model->class_names[0] ? 0 : 1;
    EXPECT_GT(classifier.probability()[label], 0.5) << contact.id;
  }
}

TEST(FitModelTest, CuesThatSayNothingAreRefused) {
  const auto contacts = ContactsByPlace();
  auto reason = [](const std::vector<LabelledContact>& given,
                   const FitOptions& options) {
    return ReasonOf(
        FitModel(testing::PointersTo(given), options, RunSerially).status());
  };
  FitOptions options = *FitPreset("profile");
  auto ideal = contacts;
  ideal.back().layout = {};
  EXPECT_EQ(reason(ideal, options), "INVALID_TRAINING_DATA");
  options.hmm_cues.clear();
  options.lstm.networks = 1;
  options.lstm.cues = {NamedCue("log_time"), NamedCue("row_load_3")};
  EXPECT_EQ(reason(ideal, options), "INVALID_TRAINING_DATA");
  options.lstm.cues = {NamedCue("log_time"), NamedCue("log_row_spread")};
  EXPECT_EQ(reason(ideal, options), "INVALID_TRAINING_DATA");
  options = *FitPreset("profile");
  options.features = {Feature::kMotion, Feature::kArea};
  EXPECT_EQ(reason(contacts, options), "INVALID_CONFIG");
}

// Only skins of three axes have shear.
TEST(FitOptionsTest, CuesOfShearNeedThreeAxes) {
  auto contacts = ContactsByPlace();
  const FitOptions options = *FitPreset("tuned");
  const std::vector<Cue> shear = CuesOfGroup("shear");
  const auto with_shear = [&](const std::vector<Cue>& cues) {
    return std::ranges::count_if(
        cues, [&](Cue cue) { return std::ranges::count(shear, cue) > 0; });
  };
  const FitOptions one = SuitedToAxes(options, testing::PointersTo(contacts));
  EXPECT_EQ(with_shear(one.hmm_cues), 0);
  EXPECT_EQ(one.lstm.cues, StandardCues());
  EXPECT_EQ(one.hmm_cues.size() + shear.size(), options.hmm_cues.size());
  for (LabelledContact& contact : contacts) contact.layout.axes = 3;
  const FitOptions three = SuitedToAxes(options, testing::PointersTo(contacts));
  EXPECT_EQ(three.hmm_cues, options.hmm_cues);
  EXPECT_EQ(three.lstm.cues, options.lstm.cues);
  EXPECT_EQ(with_shear(three.hmm_cues), 8);
  // One of them feels no shear.
  contacts.back().layout.axes = 1;
  EXPECT_EQ(SuitedToAxes(options, testing::PointersTo(contacts)).hmm_cues,
            one.hmm_cues);
}

// Two classes that only shear tells apart.
TEST(FitModelTest, ModelsLearnFromShear) {
  Random random(5);
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 24; ++i) {
    LabelledContact& contact = contacts.emplace_back();
    contact.id = std::to_string(i);
    contact.label = i % 2 == 0 ? "slip" : "hold";
    contact.condition = std::to_string(i % 3);
    contact.layout =
        testing::FlatLayout("mine", 4, 4, TaxelUnit::kCounts, 1, 1);
    contact.layout.axes = 3;
    contact.layout.normal_axis = 2;
    for (int t = 0; t < 60; ++t) {
      ContactFrame frame;
      const double force = 5 + 0.1 * random.Gaussian();
      frame.sample.features = {force, 1e-4, 0};
      frame.sample.net_force = force;
      const double pull = i % 2 == 0 ? 2 : 0.2;
      frame.sample.shear = {static_cast<float>(pull + 0.02 * random.Gaussian()),
                            0};
      contact.frames.push_back(frame);
    }
  }
  FitOptions options = *FitPreset("whole-skin");
  options.hmm_cues = {NamedCue("log_peak"), NamedCue("log_shear_ratio")};
  options.hmms_per_class = 2;
  const auto model =
      FitModel(testing::PointersTo(contacts), options, RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  const auto compiled = *CompiledModel::Create(*model);
  for (const LabelledContact& contact : contacts) {
    ContactClassifier classifier(compiled, {});
    EXPECT_TRUE(classifier.uses_shear());
    for (const auto& frame : contact.frames) classifier.StepOrHold(frame, 0);
    EXPECT_EQ(model->class_names[classifier.best_class()], contact.label);
  }
}

TEST(FitPresetTest, AcceptsItsNames) {
  EXPECT_EQ(FitPreset("paper")->score, Score::kViterbi);
  EXPECT_FALSE(FitPreset("paper")->log_features);
  EXPECT_EQ(FitPreset("paper")->lstm.steps.max, 1u);
  EXPECT_EQ(FitPreset("tuned")->lstm.networks, 1);
  std::vector<Cue> profile = CuesOfGroup("load_profile");
  const std::vector<Cue> shear = CuesOfGroup("shear");
  profile.insert(profile.end(), shear.begin(), shear.end());
  EXPECT_EQ(FitPreset("profile")->hmm_cues, profile);
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
}  // namespace tactus::internal
