// A wrong name of a model was refused without the right ones, "pad@1" worked in
// trainctl but not in streams, and a skin that the model did not fit was left
// without a next step: "another one may do without".
#include "core/base/errors.h"
#include "core/bundle/bundle.h"
#include "core/skin/layout.h"
#include "core/skin/layout_proto.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/registry/model_registry.h"
#include "server/session/stream_session.h"
#include "tests/server/support/requests.h"
#include "tests/support/small_model.h"

namespace tactus::internal::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string Bundle(PoseNeed poses, const std::string& layout) {
  Model model = testing::SmallModel();
  model.layout = *LayoutPreset(layout);
  model.poses = poses;
  return *EncodeBundle(model);
}

void Fill(ModelRegistry& registry) {
  ASSERT_TRUE(
      registry.AddBuiltIn("default", Bundle(PoseNeed::kNeeded, "cody-forearm"))
          .ok());
  ASSERT_TRUE(
      registry.AddBuiltIn("pad", Bundle(PoseNeed::kIgnored, "cody-forearm"))
          .ok());
  ASSERT_TRUE(
      registry.AddBuiltIn("pad", Bundle(PoseNeed::kIgnored, "cody-forearm"))
          .ok());
}

TEST(NamesOfModelsTest, AVersionAsUsersWriteIt) {
  ModelRegistry registry;
  Fill(registry);
  for (const char* name : {"pad@1", "models/pad@1"}) {
    const auto found = registry.Find(name, "");
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_EQ(found->version_name, "models/pad/versions/1");
  }
  for (const char* name : {"pad@", "pad@0", "pad@x", "@1", "pad@1@1"}) {
    EXPECT_EQ(ReasonOf(registry.Find(name, "").status()), "MODEL_NOT_FOUND")
        << name;
  }
}

TEST(NamesOfModelsTest, AWrongNameIsAnsweredWithTheRightOnes) {
  ModelRegistry registry;
  Fill(registry);
  EXPECT_THAT(registry.Find("pda", "").status().message(),
              AllOf(HasSubstr("\"pda\""), HasSubstr("models/default"),
                    HasSubstr("models/pad")));
  EXPECT_THAT(
      registry.Find("pad@7", "").status().message(),
      AllOf(HasSubstr("there is pad@2, pad@1"), Not(HasSubstr("default"))));
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(registry
                    .AddBuiltIn("model-" + std::to_string(i),
                                Bundle(PoseNeed::kIgnored, "cody-forearm"))
                    .ok());
  }
  const absl::Status many = registry.Find("pda", "").status();
  EXPECT_THAT(many.message(), HasSubstr("and 34 more"));
  EXPECT_LT(many.message().size(), 400u);
}

std::string ErrorOf(const ModelRegistry& registry,
                    const v1::ClassifyContactRequest& request) {
  StreamSession session(&registry, {});
  return std::string(session.OnRequest(request).message());
}

TEST(NamesOfModelsTest, ASkinWithoutPosesGetsTheModelsThatDoWithout) {
  ModelRegistry registry;
  Fill(registry);
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  request.mutable_config()->set_model("default");
  request.mutable_config()->set_with_poses(false);
  EXPECT_THAT(ErrorOf(registry, request),
              AllOf(HasSubstr("with_poses"), HasSubstr("models/default"),
                    HasSubstr("models/pad/versions/2 would do"),
                    Not(HasSubstr("train one"))));
}

TEST(NamesOfModelsTest, ASkinThatNoModelFitsGetsTheNextStep) {
  ModelRegistry registry;
  Fill(registry);
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  request.mutable_config()->set_model("pad");
  request.mutable_config()->mutable_geometry()->set_layout("vitac-12x32");
  EXPECT_THAT(ErrorOf(registry, request),
              AllOf(HasSubstr("vitac-12x32"), HasSubstr("models/pad"),
                    HasSubstr("train one: "), HasSubstr("trainctl fit")));
}

TEST(NamesOfModelsTest, AStreamWithoutAModelGetsOneThatFits) {
  ModelRegistry registry;
  Fill(registry);
  const auto model_of = [&](const v1::ClassifyContactRequest& request) {
    StreamSession session(&registry, {});
    const absl::Status status = session.OnRequest(request);
    if (!status.ok()) return std::string(status.message());
    return session.responses().StartWrite(0)->started().model_version();
  };
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  request.mutable_config()->set_with_poses(true);
  EXPECT_EQ(model_of(request), "models/default/versions/1");
  // The default needs poses.
  request.mutable_config()->set_with_poses(false);
  EXPECT_EQ(model_of(request), "models/pad/versions/2");
  // The first by name.
  ASSERT_TRUE(
      registry.AddBuiltIn("arm", Bundle(PoseNeed::kIgnored, "cody-forearm"))
          .ok());
  EXPECT_EQ(model_of(request), "models/arm/versions/1");
  request.mutable_config()->mutable_geometry()->set_layout("vitac-12x32");
  EXPECT_THAT(
      model_of(request),
      AllOf(HasSubstr("models/arm/versions/1 needs cody-forearm 16x24"),
            HasSubstr("models/default/versions/1 needs cody-forearm 16x24"),
            HasSubstr("with poses"), HasSubstr("train one: ")));
}

TEST(NamesOfModelsTest, AStreamLearnsOfNewerVersionsOfTheModelThatItGot) {
  ModelRegistry registry;
  Fill(registry);
  StreamSession session(&registry, {});
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  ASSERT_TRUE(session.OnRequest(request).ok());
  ASSERT_TRUE(
      registry.AddBuiltIn("pad", Bundle(PoseNeed::kIgnored, "cody-forearm"))
          .ok());
  ASSERT_TRUE(
      session.OnRequest(testing::DenseU16(1, {testing::Untouched()})).ok());
  EXPECT_TRUE(session.responses().StartWrite(0)->has_started());
  session.responses().FinishWrite();
  EXPECT_EQ(session.responses().StartWrite(0)->notice().kind(),
            v1::StreamNotice::KIND_MODEL_SUPERSEDED);
}

TEST(NamesOfModelsTest, AServerWithoutModelsSaysSo) {
  const ModelRegistry registry;
  EXPECT_THAT(ErrorOf(registry, testing::ConfigRequest()),
              HasSubstr("does not exist"));
}

// A wrong config is no matter of models.
TEST(NamesOfModelsTest, AWrongRateGetsNoModels) {
  ModelRegistry registry;
  Fill(registry);
  v1::ClassifyContactRequest request = testing::ConfigRequest();
  request.mutable_config()->set_sample_rate_hz(-5);
  EXPECT_THAT(ErrorOf(registry, request), Not(HasSubstr("train one")));
}

}  // namespace
}  // namespace tactus::internal::server
