#include "core/stream/stream_started.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/support/requests.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

using ::testing::ElementsAre;

TEST(StreamStartedTest, SaysWhatTheModelAnswers) {
  const auto model = *CompiledModel::Create(testing::SmallModel());
  const StreamSettings settings =
      *ParseStreamConfig(testing::ConfigRequest().config());
  v1::StreamStarted started;
  started.set_model_version("models/m/versions/1");
  WriteStarted(settings, *model, &started);
  EXPECT_EQ(started.model_version(), "models/m/versions/1");
  EXPECT_THAT(started.class_names(), ElementsAre("HU", "HM", "SU", "SM"));
  ASSERT_EQ(started.questions_size(), 2);
  EXPECT_EQ(started.questions(0).name(), "hardness");
  EXPECT_EQ(started.questions(0).kind(), v1::Question::KIND_PROPERTY);
  EXPECT_EQ(started.questions(1).kind(), v1::Question::KIND_STATE);
  EXPECT_THAT(started.questions(1).values(), ElementsAre("unmoved", "moved"));
  EXPECT_EQ(started.geometry().rows(), 16u);
  // The configuration lets contacts end with the trial only.
  EXPECT_EQ(started.limits().max_contacts(), 1u);
  EXPECT_FALSE(started.has_trained_geometry());
}

}  // namespace
}  // namespace tactus::internal
