#include "core/contacts/labelled_contact.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace tactus::internal {
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

TEST(ExtractContactTest, TheSpreadOfTheLoadIsInMetres) {
  Trial trial = TaxelTrial(2);
  // Two taxels of one column, 1 to 3.
  trial.taxels.u16[384 + 100] = 100;
  trial.taxels.u16[384 + 124] = 300;
  const auto contact = ExtractContact(trial, {.whole_skin = false});
  ASSERT_TRUE(contact.ok() && contact->has_value()) << contact.status();
  const LoadSpread spread = (*contact)->frames.back().sample.spread;
  EXPECT_NEAR(spread.rows, 0.0108 * 0.0108 * 3 / 16, 1e-10);
  EXPECT_EQ(spread.columns, 0);
}

// Its label is that of the first touch: models would learn wrong labels.
TEST(ExtractContactTest, ATrialOfSeveralTouchesIsRefused) {
  Trial trial;
  trial.id = "000003";
  trial.time = {0, 0.01, 0.02};
  trial.signals = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  trial.label = "HU";
  Touch touch;
  touch.label = "HU";
  trial.touches = {touch};
  EXPECT_TRUE(ExtractContact(trial).ok());
  trial.touches.push_back(touch);
  const absl::Status status = ExtractContact(trial).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  EXPECT_THAT(std::string(status.message()),
              ::testing::HasSubstr("trial 000003 has 2 touches"));
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
  EXPECT_EQ(ReasonOf(ExtractContact(trial, {.layout = &mine}).status()),
            "INVALID_CONFIG");
  trial.unit = "counts";
  EXPECT_TRUE(ExtractContact(trial, {.layout = &mine}).ok());
}

// Touched in frames 10 to 19 and 80 to 89: with 0.5 s, these are two contacts.
TEST(ExtractContactTest, AReleaseLeavesTheLastContact) {
  Trial trial = TaxelTrial(200);
  for (int t = 10; t < 20; ++t) trial.taxels.u16[t * 384 + 100] = 500;
  for (int t = 80; t < 90; ++t) trial.taxels.u16[t * 384 + 100] = 900;
  trial.object_motion.assign(200, 0.25);
  EXPECT_EQ((*ExtractContact(trial))->frames.size(), 190u);
  const auto last = *ExtractContact(trial, {.release_after_s = 0.5});
  // Ten touched frames, and 49 of the loss that ends it.
  ASSERT_EQ(last->frames.size(), 59u);
  EXPECT_EQ(last->object_motion.size(), 59u);
  EXPECT_FLOAT_EQ(last->frames[0].sample.features[0], 0.9F);
  // A loss of 60 frames does not end it.
  EXPECT_EQ((*ExtractContact(trial, {.release_after_s = 0.7}))->frames.size(),
            149u);
}

}  // namespace
}  // namespace tactus::internal
