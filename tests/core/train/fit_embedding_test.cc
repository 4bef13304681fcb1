#include "core/inputs/fit_embedding.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/bundle/bundle.h"
#include "core/bundle/model_proto.h"
#include "core/classify/compiled_model.h"
#include "core/classify/contact_classifier.h"
#include "core/train/fit.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"
#include "tests/support/flat_layout.h"
#include "tests/support/pattern_contacts.h"

namespace tactus::internal {
namespace {

// Between over within variance of number `d` of the last frames.
double Separation(const std::vector<LabelledContact>& contacts,
                  const TaxelEmbedding& embedding, int d) {
  double sum[3] = {};
  double squares = 0;
  double total = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    EmbeddingTracker tracker(&embedding, 100);
    for (const ContactFrame& frame : contacts[i].frames) {
      tracker.Step(frame.sample.loads);
    }
    const double value = tracker.values()[d];
    sum[i % 3] += value;
    squares += value * value;
    total += value;
  }
  const double n = static_cast<double>(contacts.size());
  double between = 0;
  for (const double s : sum) between += 3 * s * s / n;
  const double all = squares - total * total / n;
  between -= total * total / n;
  return between / (all - between);
}

TEST(FitTaxelEmbeddingTest, SeparatesClassesBetterThanAnyTaxel) {
  const auto contacts = testing::ContactsByPattern();
  auto embedding =
      FitTaxelEmbedding(testing::PointersTo(contacts), {"a", "b", "c"}, {});
  ASSERT_TRUE(embedding.ok()) << embedding.status();
  // Two discriminants of three classes; as many components as taxels.
  ASSERT_EQ(embedding->dimensions, 2 + 12);
  EXPECT_TRUE(Validate(*embedding).ok());
  const double best = Separation(contacts, *embedding, 0);
  for (int t = 0; t < 12; ++t) {
    TaxelEmbedding single = {
        .taxels = 12, .dimensions = 1, .weights = std::vector<float>(24)};
    single.weights[2 * t] = 1;
    EXPECT_GT(best, Separation(contacts, single, 0)) << t;
  }
  EXPECT_GT(best, 1);
  EXPECT_GT(Separation(contacts, *embedding, 1), 0.5);
}

// Twenty classes, each of which presses one of twenty taxels harder.
TEST(FitTaxelEmbeddingTest, ManyClassesHaveAllTheirDiscriminants) {
  Random random(12);
  std::vector<LabelledContact> contacts;
  std::vector<std::string> classes;
  for (int i = 0; i < 60; ++i) {
    LabelledContact contact;
    contact.id = std::to_string(i);
    contact.label = std::string(1, static_cast<char>('a' + i % 20));
    if (i < 20) classes.push_back(contact.label);
    contact.layout = testing::FlatLayout(4, 6);
    contact.with_poses = false;
    for (int n = 0; n < 30; ++n) {
      std::vector<TaxelLoad> loads;
      for (uint32_t t = 0; t < 20; ++t) {
        const double level = static_cast<int>(t) == i % 20 ? 4 : 3;
        loads.push_back(
            {t, static_cast<float>(level + 0.3 * random.Gaussian())});
      }
      ContactFrame frame = {IdealSample({1, 1e-4, 0})};
      frame.sample.loads = loads;
      contact.frames.push_back(frame);
    }
    contacts.push_back(std::move(contact));
  }
  auto embedding =
      FitTaxelEmbedding(testing::PointersTo(contacts), classes, {});
  ASSERT_TRUE(embedding.ok()) << embedding.status();
  EXPECT_EQ(embedding->dimensions, 19);
}

TEST(FitTaxelEmbeddingTest, TooManyOrNoTaxelsAreRefused) {
  auto contacts = testing::ContactsByPattern();
  for (LabelledContact& contact : contacts) {
    contact.layout = testing::FlatLayout(64, 64);
    contact.layout.name = "large";
    std::vector<TaxelLoad> loads;
    for (uint32_t t = 0; t < 1'025; ++t) loads.push_back({t, 1});
    ContactFrame frame = {IdealSample({1, 1e-4, 0})};
    frame.sample.loads = loads;
    contact.frames.push_back(frame);
  }
  EXPECT_EQ(ReasonOf(FitTaxelEmbedding(testing::PointersTo(contacts),
                                       {"a", "b", "c"}, {})
                         .status()),
            "INVALID_TRAINING_DATA");
  for (LabelledContact& contact : contacts) {
    contact.frames.clear();
    contact.frames.push_back({IdealSample({1, 1e-4, 0})});
  }
  EXPECT_EQ(ReasonOf(FitTaxelEmbedding(testing::PointersTo(contacts),
                                       {"a", "b", "c"}, {})
                         .status()),
            "INVALID_TRAINING_DATA");
}

TEST(FitPatternTest, AModelOfTaxelsSurvivesItsFile) {
  const auto contacts = testing::ContactsByPattern();
  for (const char* preset : {"pattern", "whole-skin", "ridge"}) {
    SCOPED_TRACE(preset);
    FitOptions options = *FitPreset(preset);
    options.lstm.networks = 1;
    options.lstm.training.epochs = 2;
    auto model = FitModel(testing::PointersTo(contacts), options, RunSerially);
    ASSERT_TRUE(model.ok()) << model.status();
    auto back = ModelFromProto(ModelToProto(*model));
    ASSERT_TRUE(back.ok()) << back.status();
    auto compiled = CompiledModel::Create(*back);
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    EXPECT_TRUE(RunWarmUp(**compiled).ok());
    // A warm-up whose taxels got lost is found.
    Model broken = *model;
    for (TaxelLoad& load : broken.warm_up.loads) load.root = 0;
    EXPECT_FALSE(RunWarmUp(**CompiledModel::Create(broken)).ok());
    broken = *model;
    broken.warm_up.load_ends.pop_back();
    EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
    broken = *model;
    broken.inputs.embedding = {};
    EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
  }
}

TEST(FitPatternTest, PresetsOfTaxelsFindThePattern) {
  const auto contacts = testing::ContactsByPattern();
  for (const char* preset : {"pattern", "ridge", "trees", "nearest"}) {
    SCOPED_TRACE(preset);
    auto model = FitModel(testing::PointersTo(contacts), *FitPreset(preset),
                          RunSerially);
    ASSERT_TRUE(model.ok()) << model.status();
    auto compiled = CompiledModel::Create(*std::move(model));
    ASSERT_TRUE(compiled.ok()) << compiled.status();
    for (const LabelledContact& contact : contacts) {
      ContactClassifier classifier(*compiled, {});
      EXPECT_TRUE(classifier.uses_taxels());
      for (const auto& frame : contact.frames) classifier.StepOrHold(frame, 0);
      EXPECT_GT(classifier.probability()[contact.label[0] - 'a'], 0.5)
          << contact.id;
    }
  }
}

TEST(FitPatternTest, ARidgeStandsAlone) {
  const auto contacts = testing::ContactsByPattern();
  const auto model =
      FitModel(testing::PointersTo(contacts), *FitPreset("ridge"), RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_TRUE(NeedsSkin(*model));
  EXPECT_EQ(BundleFormatVersion(*model), kBundleFormatVersionRecordings);
  EXPECT_EQ(model->poses, PoseNeed::kEither);
  Model broken = *model;
  broken.hmms.resize(broken.class_names.size());
  EXPECT_THAT(Validate(broken).message(),
              ::testing::HasSubstr("none beside a ridge"));
  broken = *model;
  broken.ridge->bias.push_back(0);
  EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
  broken = *model;
  broken.layout = testing::FlatLayout(3, 3);
  EXPECT_THAT(Validate(broken).message(),
              ::testing::HasSubstr("rows and columns of a ridge"));
  broken = *model;
  broken.ridge.reset();
  EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
}

TEST(FitPatternTest, NearestNeighboursStandAlone) {
  const auto contacts = testing::ContactsByPattern();
  const auto model = FitModel(testing::PointersTo(contacts),
                              *FitPreset("nearest"), RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_TRUE(NeedsSkin(*model));
  EXPECT_FALSE(HasHmms(*model));
  EXPECT_EQ(BundleFormatVersion(*model), kBundleFormatVersionRecordings);
  const auto read = DecodeBundle(*EncodeBundle(*model));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ((*read)->model().nearest->sample, model->nearest->sample);
  EXPECT_EQ((*read)->model().nearest->view, model->nearest->view);
  Model broken = *model;
  broken.ridge.emplace();
  EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
  broken = *model;
  broken.hmms.resize(broken.class_names.size());
  EXPECT_THAT(Validate(broken).message(),
              ::testing::HasSubstr("none beside nearest neighbours"));
  broken = *model;
  broken.layout = testing::FlatLayout(3, 3);
  EXPECT_THAT(Validate(broken).message(),
              ::testing::HasSubstr("rows and columns of nearest neighbours"));
}

TEST(FitPatternTest, TreesStandAlone) {
  const auto contacts = testing::ContactsByPattern();
  const auto model =
      FitModel(testing::PointersTo(contacts), *FitPreset("trees"), RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  EXPECT_TRUE(NeedsSkin(*model));
  EXPECT_EQ(BundleFormatVersion(*model), kBundleFormatVersionRecordings);
  const auto read = DecodeBundle(*EncodeBundle(*model));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ((*read)->model().trees->number, model->trees->number);
  EXPECT_EQ((*read)->model().trees->threshold, model->trees->threshold);
  EXPECT_EQ((*read)->model().trees->root, model->trees->root);
}

TEST(FitPatternTest, CopiesAndIdealSignalsAreRefused) {
  for (const char* preset : {"pattern", "ridge", "nearest"}) {
    auto contacts = testing::ContactsByPattern();
    FitOptions options = *FitPreset(preset);
    options.variations.copies = 1;
    const auto reason = [&] {
      return ReasonOf(
          FitModel(testing::PointersTo(contacts), options, RunSerially)
              .status());
    };
    EXPECT_EQ(reason(), "INVALID_CONFIG");
    options.variations.copies = 0;
    for (LabelledContact& contact : contacts) contact.layout = {};
    EXPECT_EQ(reason(), "INVALID_TRAINING_DATA");
  }
}

}  // namespace
}  // namespace tactus::internal
