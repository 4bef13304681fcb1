#include "core/train/labelled_contact.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus {
namespace {

Trial TaxelTrial(int frames) {
  Trial trial;
  trial.id = "000000";
  trial.label = "HU";
  trial.layout = "cody-forearm";
  trial.taxels.rows = 16;
  trial.taxels.columns = 24;
  trial.taxels.scale = 0.001;
  trial.taxels.u16.assign(static_cast<size_t>(frames) * 384, 0);
  for (int t = 0; t < frames; ++t) trial.time.push_back(t * 0.01);
  return trial;
}

TEST(ExtractContactTest, BeginsAtOnsetAndEndsWithTheTrial) {
  Trial trial = TaxelTrial(200);
  for (int t = 50; t < 60; ++t) trial.taxels.u16[t * 384 + 100] = 500;
  auto contact = ExtractContact(trial);
  ASSERT_TRUE(contact.ok()) << contact.status();
  ASSERT_TRUE(contact->has_value());
  ASSERT_EQ((*contact)->frames.size(), 150u);
  EXPECT_FLOAT_EQ((*contact)->frames[0].sample.features[0], 0.5F);
  EXPECT_DOUBLE_EQ((*contact)->frames[0].sample.features[1], 81e-6);
  EXPECT_TRUE((*contact)->frames[9].touched);
  EXPECT_FALSE((*contact)->frames[10].touched);
  EXPECT_EQ((*contact)->layout.name, "cody-forearm");
}

TEST(ExtractContactTest, BelowOnsetItIsUndetectable) {
  Trial trial = TaxelTrial(20);
  // Above contact_threshold, below onset_threshold.
  trial.taxels.u16[7] = 15;
  auto contact = ExtractContact(trial);
  ASSERT_TRUE(contact.ok());
  EXPECT_FALSE(contact->has_value());
}

TEST(ExtractContactTest, SignalsAreTakenAsTheyAre) {
  Trial trial;
  trial.signals = {{1, 2, 3}, {4, 5, 6}};
  auto contact = ExtractContact(trial);
  ASSERT_TRUE(contact.ok());
  ASSERT_EQ((*contact)->frames.size(), 2u);
  EXPECT_EQ((*contact)->frames[1].sample.features, trial.signals[1]);
  EXPECT_EQ((*contact)->frames[1].sample.net_force, trial.signals[1][0]);
  EXPECT_EQ((*contact)->layout.name, "");
}

TEST(ExtractContactTest, ShapeAndNameMustFitTheLayout) {
  Trial trial = TaxelTrial(2);
  trial.taxels.rows = 12;
  trial.taxels.columns = 32;
  EXPECT_EQ(ReasonOf(ExtractContact(trial).status()), "INVALID_CONFIG");
  trial.layout = "mine";
  EXPECT_EQ(ReasonOf(ExtractContact(trial).status()), "UNKNOWN_LAYOUT");
  SkinLayout mine = *LayoutPreset("vitac-12x32");
  mine.name = "mine";
  EXPECT_TRUE(ExtractContact(trial, &mine).ok());
}

}  // namespace
}  // namespace tactus
