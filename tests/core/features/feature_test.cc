#include "core/features/feature.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(FeatureTest, SubsetsReadAndWriteInTheOrderGiven) {
  const struct {
    const char* text;
    const char* brief;
  } cases[] = {{"f,m,a", "f,m,a"},
               {"force,area,motion", "f,a,m"},
               {"m", "m"},
               {"motion,f", "m,f"}};
  for (const auto& c : cases) {
    auto features = ParseFeatures(c.text);
    ASSERT_TRUE(features.ok()) << c.text;
    EXPECT_EQ(FeaturesToString(*features), c.brief);
  }
}

TEST(FeatureTest, AnythingElseIsRefusedByName) {
  for (const char* text : {"", "f,", "x", "f,f", "force,f", "f m", "F"}) {
    const absl::Status status = ParseFeatures(text).status();
    EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << text;
    EXPECT_EQ(InfoOf(status).metadata().at("value"), text);
  }
}

}  // namespace
}  // namespace tactus::internal
