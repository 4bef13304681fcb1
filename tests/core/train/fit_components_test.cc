// Learners that see all taxels on skins whose loads do not tell the class: the
// shear does, or an auxiliary taxel.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/bundle/bundle.h"
#include "core/classify/contact_pipeline.h"
#include "core/train/fit.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

constexpr int kFrames = 40;
constexpr const char* kPresets[] = {"ridge", "trees", "nearest"};

SkinLayout ShearSkin() {
  SkinLayout skin = testing::FlatLayout("pad", 2, 3, TaxelUnit::kCounts, 1, 1);
  skin.axes = 3;
  skin.normal_axis = 2;
  skin.signed_values = true;
  return skin;
}

SkinLayout JointSkin() {
  SkinLayout skin = testing::FlatLayout("arm", 2, 3, TaxelUnit::kCounts, 1, 1);
  skin.signed_values = true;
  skin.normal_axis = 0;
  EXPECT_TRUE(AddAuxiliary({4}, skin).ok());
  return skin;
}

// A press on taxels 0 and 1 that is the same for both classes, with noise. On
// three axes class 0 is pulled to the one side and class 1 to the other; on one
// axis taxel 4 reads -1 or 1.
Trial MakeTrial(const SkinLayout& skin, int label, Random& random) {
  Trial trial;
  trial.label = label == 0 ? "left" : "right";
  const double side = label == 0 ? -1 : 1;
  for (int t = 0; t < kFrames; ++t) {
    trial.time.push_back(0.01 * t);
    std::vector<float> frame(skin.values());
    for (int taxel = 0; taxel < 2; ++taxel) {
      float* const values = &frame[static_cast<size_t>(taxel) * skin.axes];
      const double load = 5 + random.Uniform(-1, 1);
      if (skin.axes == 3) {
        values[0] = static_cast<float>(side * load / 10);
        values[2] = static_cast<float>(load);
      } else {
        values[0] = static_cast<float>(load);
      }
    }
    if (skin.axes == 1) frame[4] = static_cast<float>(side);
    trial.taxels.f32.insert(trial.taxels.f32.end(), frame.begin(), frame.end());
  }
  trial.taxels.SetShape(skin);
  SetSkin(skin, trial);
  return trial;
}

std::vector<LabelledContact> MakeContacts(const SkinLayout& skin) {
  Random random(5);
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 24; ++i) {
    Trial trial = MakeTrial(skin, i % 2, random);
    trial.id = std::to_string(i);
    auto contact = ExtractContact(trial);
    EXPECT_TRUE(contact.ok() && contact->has_value()) << contact.status();
    contacts.push_back(*std::move(*contact));
  }
  return contacts;
}

// The posterior of "right" after the frames of a trial, streamed.
double RightProbability(const std::shared_ptr<const CompiledModel>& model,
                        const Trial& trial) {
  auto pipeline = ContactPipeline::Create(*trial.skin, model, {});
  EXPECT_TRUE(pipeline.ok()) << pipeline.status();
  std::vector<float> values(trial.skin->values());
  double probability = -1;
  for (size_t t = 0; t < trial.taxels.frames(); ++t) {
    trial.taxels.Decode(t, values.data());
    for (const ContactReport& contact : (*pipeline)->Step({.taxels = values})) {
      probability = contact.classifier->probability()[1];
    }
  }
  return probability;
}

void ExpectThatTheyTell(const SkinLayout& skin) {
  const auto contacts = MakeContacts(skin);
  for (const char* preset : kPresets) {
    SCOPED_TRACE(preset);
    const auto model = FitModel(testing::PointersTo(contacts),
                                *FitPreset(preset), RunSerially);
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_TRUE(NeedsComponents(*model));
    EXPECT_EQ(BundleFormatVersion(*model), kBundleFormatVersionComponents);
    const auto served = CompiledModel::Create(*model);
    ASSERT_TRUE(served.ok()) << served.status();
    const auto read = DecodeBundle(*EncodeBundle(*model));
    ASSERT_TRUE(read.ok()) << read.status();
    Random random(6);
    for (int i = 0; i < 20; ++i) {
      const Trial trial = MakeTrial(skin, i % 2, random);
      const double right = RightProbability(*served, trial);
      EXPECT_EQ(right > 0.5, i % 2 == 1) << right;
      EXPECT_EQ(RightProbability(*read, trial), right);
    }
  }
}

TEST(FitComponentsTest, ShearTellsTheClass) { ExpectThatTheyTell(ShearSkin()); }

TEST(FitComponentsTest, AnAuxiliaryTaxelTellsTheClass) {
  ExpectThatTheyTell(JointSkin());
}

// What only the order of the recordings told is left alone: contacts of another
// condition are pulled to the other side.
TEST(FitComponentsTest, ComponentsThatMisleadOnAnotherDayAreLeftOut) {
  const SkinLayout skin = ShearSkin();
  Random random(7);
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 24; ++i) {
    const int label = i % 2;
    const bool other_day = i >= 12;
    Trial trial = MakeTrial(skin, other_day ? 1 - label : label, random);
    trial.id = std::to_string(i);
    trial.label = label == 0 ? "left" : "right";
    trial.condition = other_day ? "tuesday" : "monday";
    // What tells the class on any day.
    for (size_t v = 2; v < trial.taxels.f32.size(); v += 3) {
      trial.taxels.f32[v] *= label == 0 ? 1 : 1.5F;
    }
    contacts.push_back(**ExtractContact(trial));
  }
  for (const char* preset : {"ridge", "nearest"}) {
    const auto model = FitModel(testing::PointersTo(contacts),
                                *FitPreset(preset), RunSerially);
    ASSERT_TRUE(model.ok()) << model.status();
    EXPECT_FALSE(NeedsComponents(*model)) << preset;
    EXPECT_EQ(BundleFormatVersion(*model), kBundleFormatVersionRecordings);
  }
}

TEST(FitComponentsTest, ComponentsMustBeThoseOfTheSkin) {
  const auto contacts = MakeContacts(ShearSkin());
  const auto model =
      FitModel(testing::PointersTo(contacts), *FitPreset("ridge"), RunSerially);
  ASSERT_TRUE(model.ok()) << model.status();
  Model broken = *model;
  broken.layout.normal_axis.reset();
  EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
  broken = *model;
  broken.ridge->history.planes = 7;
  EXPECT_EQ(ReasonOf(Validate(broken)), "INVALID_MODEL");
}

}  // namespace
}  // namespace tactus::internal
