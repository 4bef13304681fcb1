#include "core/classify/contact_pipeline.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "core/skin/geometry.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

class ContactPipelineTest : public ::testing::Test {
 protected:
  ContactPipelineTest()
      : layout_(*LayoutPreset("cody-forearm")),
        taxels_(layout_.taxels()),
        model_(*CompiledModel::Create(testing::SmallModel())) {}

  std::unique_ptr<ContactPipeline> Make() {
    ContactPipeline::Options options;
    options.release_after_s = 0.05;
    return *ContactPipeline::Create(layout_, model_, options);
  }

  // A 2 x 2 region of `force` at the seam; none for 0. Returns the contact,
  // null if there is none.
  const ContactReport* Step(ContactPipeline& pipeline, float force) {
    std::fill(taxels_.begin(), taxels_.end(), 0.0F);
    for (int row : {5, 6}) {
      for (int column : {0, 23}) taxels_[row * 24 + column] = force;
    }
    const auto contacts = pipeline.Step({.taxels = taxels_});
    return contacts.empty() ? nullptr : &contacts[0];
  }

  SkinLayout layout_;
  std::vector<float> taxels_;
  std::shared_ptr<const CompiledModel> model_;
};

TEST_F(ContactPipelineTest, ReportsOneContactAfterAnother) {
  auto pipeline = Make();
  EXPECT_EQ(Step(*pipeline, 0), nullptr);
  EXPECT_EQ(pipeline->main_contact(), nullptr);
  const ContactReport* contact = Step(*pipeline, 1);
  EXPECT_TRUE(contact->onset);
  EXPECT_EQ(contact->id, 1u);
  EXPECT_EQ(contact->features->area_taxels, 4);
  for (int t = 0; t < 20; ++t) contact = Step(*pipeline, 1);
  EXPECT_EQ(contact->classifier->frames(), 21u);
  int quiet = 0;
  while (!Step(*pipeline, 0)->released()) ASSERT_LT(++quiet, 20);
  // The scores of the contact that ended stay readable.
  EXPECT_EQ(Step(*pipeline, 0), nullptr);
  EXPECT_TRUE(pipeline->main_contact()->released());
  EXPECT_GT(pipeline->main_contact()->classifier->frames(), 20u);
  contact = Step(*pipeline, 1);
  EXPECT_TRUE(contact->onset);
  EXPECT_EQ(contact->id, 2u);
  EXPECT_EQ(contact->classifier->frames(), 1u);
}

TEST_F(ContactPipelineTest, ScoresRestWhileTouchIsLost) {
  auto pipeline = Make();
  for (int t = 0; t < 10; ++t) Step(*pipeline, 1);
  const auto scores = pipeline->contacts()[0].classifier->log_likelihood();
  const std::vector<double> before(scores.begin(), scores.end());
  const ContactReport* contact = Step(*pipeline, 0);
  EXPECT_EQ(contact->phase, TouchPhase::kInContact);
  EXPECT_FALSE(contact->features->touched);
  EXPECT_EQ(std::vector<double>(scores.begin(), scores.end()), before);
  EXPECT_EQ(contact->classifier->frames(), 11u);
  Step(*pipeline, 1);
  EXPECT_NE(std::vector<double>(scores.begin(), scores.end()), before);
}

TEST_F(ContactPipelineTest, EndTrialResetsTheContactButNotTheCount) {
  auto pipeline = Make();
  Step(*pipeline, 1);
  pipeline->EndTrial();
  EXPECT_TRUE(pipeline->contacts().empty());
  EXPECT_EQ(pipeline->main_contact(), nullptr);
  const ContactReport* contact = Step(*pipeline, 1);
  EXPECT_TRUE(contact->onset);
  EXPECT_EQ(contact->id, 2u);
}

// Two contacts have the scores that each has alone.
TEST_F(ContactPipelineTest, ContactsDoNotChangeEachOthersScores) {
  const auto touch = [&](int row, int column, float force) {
    for (int i : {0, 1}) taxels_[(row + i) * 24 + column] = force;
  };
  const auto run = [&](bool first, bool second) {
    auto pipeline = Make();
    std::map<int, std::vector<double>> scores;
    for (int t = 0; t < 60; ++t) {
      std::fill(taxels_.begin(), taxels_.end(), 0.0F);
      if (first) touch(2, 3, 1 + 0.01F * static_cast<float>(t));
      // It is a contact once it has been there for two frames.
      if (second && t >= 10) touch(12, 15, 2 + 0.02F * static_cast<float>(t));
      for (const ContactReport& contact : pipeline->Step({.taxels = taxels_})) {
        const auto score = contact.classifier->log_likelihood();
        scores[static_cast<int>(contact.features->centroid.row)] = {
            score.begin(), score.end()};
      }
    }
    return scores;
  };
  const auto both = run(true, true);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both.at(2), run(true, false).at(2));
  // Alone it begins a frame earlier.
  EXPECT_NE(both.at(12), run(false, true).at(12));
}

TEST_F(ContactPipelineTest, AModelThatSeesTheWholeSkinHasOneContact) {
  EXPECT_EQ(Make()->max_contacts(), limits::kMaxContacts);
  Model model = testing::SmallModel();
  model.inputs.hmm[0].cue = NamedCue("row_load_1");
  model_ = *CompiledModel::Create(std::move(model));
  EXPECT_EQ(Make()->max_contacts(), 1);
}

TEST_F(ContactPipelineTest, ContactsThatNeverEndAreOne) {
  ContactPipeline::Options options;
  options.release_after_s = -1;
  EXPECT_EQ(
      (*ContactPipeline::Create(layout_, model_, options))->max_contacts(), 1);
  options.max_contacts = 3;
  EXPECT_EQ(
      (*ContactPipeline::Create(layout_, model_, options))->max_contacts(), 3);
}

TEST_F(ContactPipelineTest, RefusesAnotherSkinOrRate) {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset("vitac-12x32");
  auto vitac = *CompiledModel::Create(model);
  EXPECT_EQ(ReasonOf(ContactPipeline::Create(layout_, vitac, {}).status()),
            "GEOMETRY_MISMATCH");
  ContactPipeline::Options options;
  options.sample_rate_hz = 106;
  EXPECT_EQ(
      ReasonOf(ContactPipeline::Create(layout_, model_, options).status()),
      "INVALID_CONFIG");
  options.sample_rate_hz = 104;
  EXPECT_TRUE(ContactPipeline::Create(layout_, model_, options).ok());
  SkinLayout bad = layout_;
  bad.rows = 0;
  EXPECT_EQ(ReasonOf(ContactPipeline::Create(bad, model_, {}).status()),
            "INVALID_CONFIG");
}

TEST_F(ContactPipelineTest, RefusesThresholdsAndPitchesItWasNotTrainedWith) {
  Model model = testing::SmallModel();
  model.layout = layout_;
  model.layout.light_touch = LightTouch{.window_s = 0.1,
                                        .rows = 3,
                                        .columns = 3,
                                        .contact_threshold = 0.001,
                                        .onset_threshold = 0.002};
  model.more_layouts = {model.layout};
  model.more_layouts[0].contact_threshold = 0.015;
  const auto compiled = *CompiledModel::Create(model);
  const auto reason = [&](const SkinLayout& layout) {
    return ReasonOf(ContactPipeline::Create(layout, compiled, {}).status());
  };
  EXPECT_EQ(reason(model.layout), "");
  EXPECT_EQ(reason(model.more_layouts[0]), "");
  // It feels a part of what the trained skin feels.
  EXPECT_EQ(reason(layout_), "");
  SkinLayout other = layout_;
  other.onset_threshold = 0.03;
  EXPECT_EQ(reason(other), "GEOMETRY_MISMATCH");
  other = layout_;
  other.row_pitch_m *= 1.01;
  EXPECT_EQ(reason(other), "GEOMETRY_MISMATCH");
  other = model.layout;
  other.light_touch->onset_threshold = 0.003;
  EXPECT_EQ(reason(other), "GEOMETRY_MISMATCH");
}

// Without poses the motion would be that of the centroid, and everything would
// look unmoved.
TEST_F(ContactPipelineTest, PosesAreDemandedOrIgnoredAsTheModelWasTrained) {
  Model model = testing::SmallModel();
  model.poses = PoseNeed::kNeeded;
  ContactPipeline::Options options;
  options.with_poses = false;
  const auto needed =
      ContactPipeline::Create(layout_, *CompiledModel::Create(model), options);
  EXPECT_EQ(ReasonOf(needed.status()), "INVALID_CONFIG");
  EXPECT_NE(needed.status().message().find("with_poses"), std::string::npos);

  model.poses = PoseNeed::kIgnored;
  options.with_poses = true;
  auto ignored =
      *ContactPipeline::Create(layout_, *CompiledModel::Create(model), options);
  model.poses = PoseNeed::kEither;
  auto used =
      *ContactPipeline::Create(layout_, *CompiledModel::Create(model), options);
  for (int row : {5, 6}) taxels_[row * 24] = 1;
  for (int t = 0; t < 5; ++t) {
    Pose pose;
    // Along the normal at column 0.
    pose.position = 0.01 * t * LinkNormal(layout_, {5.5, 0});
    ignored->Step({.taxels = taxels_, .pose = &pose});
    used->Step({.taxels = taxels_, .pose = &pose});
  }
  EXPECT_EQ(ignored->contacts()[0].features->motion_m, 0);
  EXPECT_GT(used->contacts()[0].features->motion_m, 0.02);
}

TEST_F(ContactPipelineTest, MeasuresTheSpreadIfTheModelTakesIt) {
  auto without = Make();
  Step(*without, 1);
  EXPECT_EQ(without->contacts()[0].features->spread, LoadSpread());
  Model model = testing::SmallModel();
  model.inputs.hmm[0] = {NamedCue("log_column_spread"), 0, -4};
  EXPECT_TRUE(NeedsSkin(model.inputs));
  model_ = *CompiledModel::Create(std::move(model));
  auto with = Make();
  Step(*with, 1);
  // Two columns of the same load.
  EXPECT_NEAR(std::sqrt(with->contacts()[0].features->spread.columns),
              layout_.column_pitch_m / 2, 1e-7);
  testing::AllocationCounter counter;
  for (int t = 0; t < 100; ++t) Step(*with, 1);
  EXPECT_EQ(counter.count(), 0);
}

// And so is the shear, on a skin of three axes.
TEST_F(ContactPipelineTest, MeasuresTheShearIfTheModelTakesIt) {
  SkinLayout layout = layout_;
  layout.axes = 3;
  layout.normal_axis = 2;
  layout.signed_values = true;
  std::vector<float> values(layout.values(), 0);
  for (const int taxel : {5 * 24 + 3, 5 * 24 + 4}) {
    values[3 * taxel] = -0.5F;
    values[3 * taxel + 1] = 0.25F;
    values[3 * taxel + 2] = 1;
  }
  for (const bool takes : {false, true}) {
    Model model = testing::SmallModel();
    if (takes) model.inputs.hmm[0] = {NamedCue("log_shear"), 0, -4};
    EXPECT_EQ(NeedsSkin(model.inputs), takes);
    ContactPipeline::Options options;
    options.with_poses = false;
    auto pipeline = *ContactPipeline::Create(
        layout, *CompiledModel::Create(std::move(model)), options);
    pipeline->Step({.taxels = values});
    ASSERT_EQ(pipeline->contacts().size(), 1u);
    const FrameFeatures& features = *pipeline->contacts()[0].features;
    EXPECT_EQ(features.net_force, 2);
    EXPECT_EQ(features.shear, takes ? (Shear{-1, 0.5F}) : Shear());
    testing::AllocationCounter counter;
    for (int t = 0; t < 100; ++t) {
      values[0] += 1e-3F;
      pipeline->Step({.taxels = values});
    }
    EXPECT_EQ(counter.count(), 0);
  }
}

TEST_F(ContactPipelineTest, AFrameAllocatesNothing) {
  auto pipeline = Make();
  Step(*pipeline, 1);
  testing::AllocationCounter counter;
  for (int t = 0; t < 500; ++t) Step(*pipeline, t % 50 < 30 ? 1.0F : 0.0F);
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus::internal
