// A bundle of 64 MB with nothing but empty nested messages took gigabytes to
// parse, and ended the program with bad_alloc under a memory limit.
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/bundle/bundle.h"
#include "core/bundle/field_count.h"
#include "core/bundle/model_proto.h"
#include "gtest/gtest.h"
#include "tests/support/sealed_bundle.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

using testing::SealedBundle;

// An empty field of length-delimited type.
std::string Empty(int number) {
  return {static_cast<char>(number << 3 | 2), '\0'};
}

std::string Repeat(const std::string& text, int count) {
  std::string all;
  all.reserve(text.size() * static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST(BundleThatGrowsInMemoryTest, IsRefusedBeforeItIsParsed) {
  const int hmms = v1::ModelBundle::kHmmsFieldNumber;
  const int lstm = v1::ModelBundle::kLstmFieldNumber;
  const int names = v1::ModelBundle::kClassNamesFieldNumber;
  constexpr int kUnknown = 15;
  for (const int field : {hmms, lstm, names, kUnknown}) {
    const auto model = DecodeBundle(
        SealedBundle(Repeat(Empty(field), limits::kMaxBundleFields + 1)));
    EXPECT_EQ(ReasonOf(model.status()), "BUNDLE_CORRUPT") << field;
  }
}

TEST(BundleThatGrowsInMemoryTest, NestedFieldsCount) {
  const auto& type = *v1::ModelBundle::descriptor();
  v1::ModelBundle bundle;
  for (int i = 0; i < 3; ++i) {
    v1::HmmMixture* mixture = bundle.add_hmms();
    mixture->add_components()->set_states(2);
    for (int k = 0; k < 100; ++k) mixture->add_log_weight(k);
  }
  // Three mixtures, each with a list, a component and its number of states.
  EXPECT_TRUE(HasAtMostFields(type, bundle.SerializeAsString(), 12));
  EXPECT_FALSE(HasAtMostFields(type, bundle.SerializeAsString(), 11));
}

TEST(BundleThatGrowsInMemoryTest, WrongEncodingsHaveNoCount) {
  const auto& type = *v1::ModelBundle::descriptor();
  const std::string good =
      ModelToProto(testing::SmallModel()).SerializeAsString();
  EXPECT_TRUE(HasAtMostFields(type, good, 1000));
  EXPECT_FALSE(HasAtMostFields(type, good.substr(0, good.size() - 1), 1000));
  // A group of fields within fields, which proto3 does not have.
  EXPECT_FALSE(HasAtMostFields(type, "\x1B\x1C", 1000));
}

}  // namespace
}  // namespace tactus::internal
