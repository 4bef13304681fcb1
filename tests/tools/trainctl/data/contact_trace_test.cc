#include "tools/trainctl/data/contact_trace.h"

#include "core/base/errors.h"
#include "core/classify/contact_pipeline.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"
#include "tests/tools/trainctl/data/touch_trial.h"

namespace tactus::client {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::shared_ptr<const CompiledModel> SmallCompiled() {
  auto model = CompiledModel::Create(tactus::testing::SmallModel());
  EXPECT_TRUE(model.ok()) << model.status();
  return *model;
}

TEST(ContactTraceTest, PosteriorsAreThoseOfThePipeline) {
  const Trial trial = TouchTrial(80, 80);
  const auto model = SmallCompiled();
  const auto trace = TraceContact(trial, {}, model);
  ASSERT_TRUE(trace.ok()) << trace.status();
  const SkinLayout layout = *LayoutPreset("cody-forearm");
  ContactPipeline::Options options;
  options.release_after_s = -1;
  auto pipeline = *ContactPipeline::Create(layout, model, options);
  std::vector<float> taxels(layout.taxels());
  for (int i = 0; i < 80; ++i) {
    trial.taxels.Decode(i, taxels.data());
    const auto contacts = pipeline->Step({.taxels = taxels});
    const ContactClassifier untouched(model, {});
    const ContactClassifier& c =
        contacts.empty() ? untouched : *contacts[0].classifier;
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(trace->probability[k][i], c.probability()[k]) << i;
    }
    EXPECT_EQ(trace->unknown[i], c.unknown());
  }
  const ContactClassifier& last = *pipeline->main_contact()->classifier;
  ASSERT_EQ(trace->decision.has_value(), last.decision().has_value());
  EXPECT_EQ(trace->Answer(), last.best_class());
}

TEST(ContactTraceTest, TimesCountFromTheOnset) {
  const auto trace = TraceContact(TouchTrial(80, 60), {}, nullptr);
  ASSERT_TRUE(trace.ok()) << trace.status();
  ASSERT_THAT(trace->time, SizeIs(80));
  EXPECT_DOUBLE_EQ(trace->time[10], 0.01);
  EXPECT_DOUBLE_EQ(trace->time[9], 0);
  EXPECT_DOUBLE_EQ(trace->time[79], 0.7);
  // Frame 59 is the last touched one.
  ASSERT_TRUE(trace->release_s);
  EXPECT_DOUBLE_EQ(*trace->release_s, 0.5);
  EXPECT_NEAR(trace->features[10][0], 0.05, 1e-6);
  EXPECT_NEAR(trace->features[59][0], 2, 1e-6);
  EXPECT_EQ(trace->unit, "N");
}

TEST(ContactTraceTest, WithoutAReleaseThereIsNone) {
  const auto trace = TraceContact(TouchTrial(80, 80), {}, nullptr);
  ASSERT_TRUE(trace.ok()) << trace.status();
  EXPECT_FALSE(trace->release_s);
}

TEST(ContactTraceTest, WithoutAModelThereAreNoPosteriors) {
  const auto trace = TraceContact(TouchTrial(80, 80), {}, nullptr);
  ASSERT_TRUE(trace.ok()) << trace.status();
  EXPECT_TRUE(trace->probability.empty());
  EXPECT_TRUE(trace->class_names.empty());
  EXPECT_THAT(trace->frames, SizeIs(80));
}

TEST(ContactTraceTest, ATrialThatIsNeverFeltIsRefused) {
  const auto trace = TraceContact(TouchTrial(80, 10), {}, nullptr);
  EXPECT_EQ(ReasonOf(trace.status()), "INVALID_CONFIG");
  EXPECT_THAT(std::string(trace.status().message()), HasSubstr("never felt"));
}

TEST(ContactTraceTest, IdealSignalsHaveCurvesAndNoSkin) {
  Trial trial;
  trial.id = "signals";
  for (int i = 0; i < 30; ++i) {
    trial.time.push_back(0.01 * i);
    trial.signals.push_back({0.1 * i, 1e-4, 1e-4 * i});
  }
  const auto trace = TraceContact(trial, {}, SmallCompiled());
  ASSERT_TRUE(trace.ok()) << trace.status();
  EXPECT_TRUE(trace->frames.empty());
  EXPECT_THAT(trace->probability, Each(SizeIs(30)));
  EXPECT_DOUBLE_EQ(trace->time.front(), 0.01);
}

}  // namespace
}  // namespace tactus::client
