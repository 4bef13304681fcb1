#include "tools/trainctl/data/contact_trace.h"

#include "core/base/errors.h"
#include "core/classify/contact_pipeline.h"
#include "core/contacts/labelled_contact.h"
#include "core/features/contact_time.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"
#include "tests/tools/trainctl/data/touch_trial.h"
#include "tools/trainctl/data/contact_summary.h"

namespace tactus::internal::client {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::shared_ptr<const CompiledModel> SmallCompiled() {
  auto model = CompiledModel::Create(tactus::internal::testing::SmallModel());
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

// The recorder's test has the same for what it cuts.
TEST(ContactTraceTest, ATouchOfTwoSecondsHasOneLength) {
  const Trial trial = TouchTrial(300, 10 + FramesIn(2, 100));
  const auto trace = TraceContact(trial, {}, nullptr);
  ASSERT_TRUE(trace.ok()) << trace.status();
  EXPECT_EQ(trace->release_s, 2.0);
  ContactSummary summary;
  ASSERT_TRUE(summary.Add(trial, *LayoutPreset("cody-forearm")).ok());
  EXPECT_EQ(summary.ToJson()["contact_s"]["median"], 2.0);
  // It ends with its last frame.
  const auto contact =
      ExtractContact(trial, {.release_after_s = ContactSeconds(1, 100)});
  ASSERT_TRUE(contact.ok() && contact->has_value());
  EXPECT_EQ(ContactSeconds((*contact)->frames.size(), 100), 2.0);
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
}  // namespace tactus::internal::client
