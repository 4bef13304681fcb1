#include "core/classify/contact_pipeline.h"

#include <algorithm>

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/small_model.h"

namespace tactus {
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

  // A 2 x 2 region of `force` at the seam; none for 0.
  const ContactReport& Step(ContactPipeline& pipeline, float force) {
    std::fill(taxels_.begin(), taxels_.end(), 0.0F);
    for (int row : {5, 6}) {
      for (int column : {0, 23}) taxels_[row * 24 + column] = force;
    }
    return pipeline.Step({.taxels = taxels_});
  }

  SkinLayout layout_;
  std::vector<float> taxels_;
  std::shared_ptr<const CompiledModel> model_;
};

TEST_F(ContactPipelineTest, ReportsOneContactAfterAnother) {
  auto pipeline = Make();
  EXPECT_EQ(Step(*pipeline, 0).state, ContactState::kNoContact);
  EXPECT_EQ(pipeline->report().contact_id, 0u);
  EXPECT_TRUE(Step(*pipeline, 1).onset);
  EXPECT_EQ(pipeline->report().contact_id, 1u);
  EXPECT_EQ(pipeline->report().features.area_taxels, 4);
  for (int t = 0; t < 20; ++t) Step(*pipeline, 1);
  EXPECT_EQ(pipeline->classifier().frames(), 21u);
  int quiet = 0;
  while (!Step(*pipeline, 0).released) ASSERT_LT(++quiet, 20);
  EXPECT_EQ(pipeline->report().state, ContactState::kReleased);
  // The scores of the contact that ended stay readable.
  EXPECT_GT(pipeline->classifier().frames(), 20u);
  EXPECT_TRUE(Step(*pipeline, 1).onset);
  EXPECT_EQ(pipeline->report().contact_id, 2u);
  EXPECT_EQ(pipeline->classifier().frames(), 1u);
}

TEST_F(ContactPipelineTest, ScoresRestWhileTouchIsLost) {
  auto pipeline = Make();
  for (int t = 0; t < 10; ++t) Step(*pipeline, 1);
  const auto scores = pipeline->classifier().log_likelihood();
  const std::vector<double> before(scores.begin(), scores.end());
  Step(*pipeline, 0);
  EXPECT_EQ(pipeline->report().state, ContactState::kInContact);
  EXPECT_EQ(std::vector<double>(scores.begin(), scores.end()), before);
  EXPECT_EQ(pipeline->classifier().frames(), 11u);
  Step(*pipeline, 1);
  EXPECT_NE(std::vector<double>(scores.begin(), scores.end()), before);
}

TEST_F(ContactPipelineTest, EndTrialResetsTheContactButNotTheCount) {
  auto pipeline = Make();
  Step(*pipeline, 1);
  pipeline->EndTrial();
  EXPECT_EQ(pipeline->report().state, ContactState::kNoContact);
  EXPECT_EQ(pipeline->classifier().frames(), 0u);
  EXPECT_TRUE(Step(*pipeline, 1).onset);
  EXPECT_EQ(pipeline->report().contact_id, 2u);
}

TEST_F(ContactPipelineTest, ReportsTheDecisionOnItsFrameOnly) {
  auto pipeline = Make();
  int decided = 0;
  for (int t = 0; t < 200; ++t) decided += Step(*pipeline, 2.7F).decided;
  EXPECT_EQ(decided, 1);
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

TEST_F(ContactPipelineTest, AFrameAllocatesNothing) {
  auto pipeline = Make();
  Step(*pipeline, 1);
  testing::AllocationCounter counter;
  for (int t = 0; t < 500; ++t) Step(*pipeline, t % 50 < 30 ? 1.0F : 0.0F);
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace tactus
