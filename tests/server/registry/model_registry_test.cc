#include "server/registry/model_registry.h"

#include <atomic>
#include <thread>

#include "core/base/errors.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/registry/default_bundle.h"
#include "tests/support/small_model.h"

namespace tactus::internal::server {
namespace {

std::string Bundle(uint64_t seed = 0) {
  Model model = testing::SmallModel();
  model.provenance.seed = seed;
  return *EncodeBundle(model);
}

TEST(ModelRegistryTest, FindsAModelByAllItsNames) {
  ModelRegistry registry;
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(1)).ok());
  for (const char* name : {"", "default", "models/default",
                           "models/default/versions/1", "default/versions/1"}) {
    const auto pinned = registry.Find(name, "");
    ASSERT_TRUE(pinned.ok()) << name << ": " << pinned.status();
    EXPECT_EQ(pinned->version_name, "models/default/versions/1");
    EXPECT_EQ(pinned->sha256, BundleSha256(Bundle(1)));
    EXPECT_EQ(pinned->model->model().provenance.seed, 1u);
  }
}

TEST(ModelRegistryTest, TheBuiltInBundleServes) {
  ModelRegistry registry;
  const absl::Status status = registry.AddBuiltIn("default", DefaultBundle());
  ASSERT_TRUE(status.ok()) << status;
  const Model& model = registry.Find("default", "")->model->model();
  EXPECT_EQ(model.class_names,
            (std::vector<std::string>{"HU", "HM", "SU", "SM"}));
  EXPECT_FALSE(model.warm_up.samples.empty());
}

TEST(ModelRegistryTest, NewVersionsReplaceButOldOnesStay) {
  ModelRegistry registry;
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(1)).ok());
  const PinnedModel held = *registry.Find("default", "");
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(2)).ok());
  ASSERT_TRUE(registry.AddBuiltIn("palm-2", Bundle(3)).ok());
  EXPECT_EQ(registry.Find("default", "")->model->model().provenance.seed, 2u);
  EXPECT_EQ(registry.Find("models/default/versions/1", "")->model, held.model);
  EXPECT_EQ(registry.Find("palm-2", "")->version_name,
            "models/palm-2/versions/1");
  EXPECT_EQ(registry.versions(),
            (std::vector<std::string>{"models/default/versions/1",
                                      "models/default/versions/2",
                                      "models/palm-2/versions/1"}));
}

TEST(ModelRegistryTest, NamesThatAreNotThere) {
  ModelRegistry registry;
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle()).ok());
  for (const char* name :
       {"other", "models/", "models/other", "models/default/versions/",
        "models/default/versions/0", "models/default/versions/2",
        "models/default/versions/1x", "models/default/versions/-1",
        "models/default/versions/99999999999999999999", "Default"}) {
    const auto pinned = registry.Find(name, "");
    EXPECT_EQ(pinned.status().code(), absl::StatusCode::kNotFound) << name;
    EXPECT_EQ(ReasonOf(pinned.status()), "MODEL_NOT_FOUND") << name;
  }
}

TEST(ModelRegistryTest, ABadBundleChangesNothing) {
  ModelRegistry registry;
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(1)).ok());
  std::string flipped = Bundle(2);
  flipped[flipped.size() / 2] ^= 1;
  EXPECT_FALSE(registry.AddBuiltIn("default", flipped).ok());
  // Its self-test fails.
  Model wrong = testing::SmallModel();
  wrong.warm_up.samples = {{{1, 1, 1}, 1}};
  wrong.warm_up.probability = {1, 0, 0, 0};
  wrong.warm_up.log_likelihood = {0, 0, 0, 0};
  EXPECT_EQ(ReasonOf(registry.AddBuiltIn("default", *EncodeBundle(wrong))),
            "INVALID_MODEL");
  EXPECT_EQ(registry.versions().size(), 1u);
  EXPECT_EQ(registry.Find("default", "")->model->model().provenance.seed, 1u);
}

TEST(ModelRegistryTest, RefusesNamesThatCannotBeResourceNames) {
  ModelRegistry registry;
  for (const std::string& name :
       {std::string(), std::string("a/b"), std::string("A"), std::string("a b"),
        std::string(65, 'a')}) {
    EXPECT_EQ(ReasonOf(registry.AddBuiltIn(name, Bundle())), "INVALID_NAME")
        << name;
  }
}

TEST(ModelRegistryTest, AFileThatIsNotThere) {
  EXPECT_EQ(ReasonOf(ReadBundleFile("/no/such/file").status()), "IO");
}

// Look-ups run while versions are added; each finds a whole version.
TEST(ModelRegistryTest, SwapsUnderLookUps) {
  ModelRegistry registry;
  ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(1)).ok());
  std::atomic<bool> stop = false;
  std::thread reader([&] {
    uint64_t last = 0;
    while (!stop) {
      const PinnedModel pinned = *registry.Find("default", "");
      const uint64_t seed = pinned.model->model().provenance.seed;
      EXPECT_GE(seed, last);
      EXPECT_EQ(pinned.version_name,
                "models/default/versions/" + std::to_string(seed));
      last = seed;
    }
  });
  for (uint64_t seed = 2; seed <= 40; ++seed) {
    ASSERT_TRUE(registry.AddBuiltIn("default", Bundle(seed)).ok());
  }
  stop = true;
  reader.join();
}

}  // namespace
}  // namespace tactus::internal::server
