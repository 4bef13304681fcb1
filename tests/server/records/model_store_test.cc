#include "server/records/model_store.h"

#include <cmath>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;

constexpr char kAlias[] = "aliases/palm";

class ModelStoreTest : public ::testing::Test {
 protected:
  void Reopen() {
    stores_.reset();
    stores_ = std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data");
  }
  std::string Add(uint64_t seed, const char* model = "models/m") {
    const auto version =
        stores_->models->AddVersion(model, TestBundle(seed), {}, kCaller);
    EXPECT_TRUE(version.ok()) << version.status();
    return version->name();
  }
  absl::StatusOr<v1::Alias> Promote(const std::string& version,
                                    const std::string& etag = "") {
    v1::PromoteSpec spec;
    spec.set_alias(kAlias);
    spec.set_model_version(version);
    spec.set_etag(etag);
    return stores_->models->Promote(spec, false, kCaller);
  }
  std::string Served(const char* client = "") {
    const auto pinned = stores_->registry.Find("palm", client);
    return pinned.ok() ? pinned->version_name : ReasonOf(pinned.status());
  }

  ScratchDir folder_;
  std::unique_ptr<Stores> stores_ =
      std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data");
};

TEST_F(ModelStoreTest, VersionsSurviveTheServer) {
  EXPECT_EQ(Add(1), "models/m/versions/1");
  EXPECT_EQ(Add(2), "models/m/versions/2");
  EXPECT_EQ(Add(2, "models/m-2"), "models/m-2/versions/1");
  for (int i = 0; i < 2; ++i) {
    const auto version = stores_->models->Get("models/m");
    ASSERT_TRUE(version.ok()) << version.status();
    EXPECT_EQ(version->name(), "models/m/versions/2");
    EXPECT_EQ(version->class_names_size(), 4);
    EXPECT_EQ(*stores_->models->Bundle(*version), TestBundle(2));
    EXPECT_EQ(stores_->registry.Find("models/m", "")->sha256,
              version->sha256());
    Reopen();
  }
  std::vector<std::string> names;
  std::string token;
  do {
    const auto page = stores_->models->List("", 1, token);
    ASSERT_TRUE(page.ok()) << page.status();
    for (const auto& version : page->items) names.push_back(version.name());
    token = page->next_token;
  } while (!token.empty());
  EXPECT_THAT(names,
              ElementsAre("models/default/versions/1", "models/m/versions/2",
                          "models/m/versions/1", "models/m-2/versions/1"));
  EXPECT_EQ(ReasonOf(stores_->models->List("", 1, "no").status()),
            "INVALID_CONFIG");
}

TEST_F(ModelStoreTest, OneOperationMakesOneVersion) {
  v1::ModelVersion origin;
  origin.set_operation("operations/7");
  for (int i = 0; i < 2; ++i) {
    const auto version =
        stores_->models->AddVersion("models/m", TestBundle(1), origin, kCaller);
    EXPECT_EQ(version->name(), "models/m/versions/1");
    Reopen();
  }
}

TEST_F(ModelStoreTest, BadBundlesAndNamesChangeNothing) {
  const auto reason = [&](const char* model, const std::string& bundle) {
    return ReasonOf(
        stores_->models->AddVersion(model, bundle, {}, kCaller).status());
  };
  std::string flipped = TestBundle(1);
  flipped[flipped.size() / 2] ^= 1;
  EXPECT_EQ(reason("models/m", flipped), "BUNDLE_CORRUPT");
  EXPECT_EQ(reason("models/m", ""), "BUNDLE_CORRUPT");
  EXPECT_EQ(reason("models/default", TestBundle(1)), "INVALID_NAME");
  EXPECT_EQ(reason("models/../m", TestBundle(1)), "INVALID_NAME");
  EXPECT_EQ(reason("models/m/versions/1", TestBundle(1)), "INVALID_NAME");
  EXPECT_EQ(stores_->models->List("", 10, "")->items.size(), 1u);
  EXPECT_EQ(stores_->data->blobs().List()->size(), 0u);
}

// A gate compares a candidate with it.
TEST_F(ModelStoreTest, ABuiltInVersionHasABundle) {
  const auto version = stores_->models->Get("models/default");
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_TRUE(version->built_in());
  const auto bundle = stores_->models->Bundle(*version);
  ASSERT_TRUE(bundle.ok()) << bundle.status();
  EXPECT_EQ(*bundle, TestBundle(0));
}

TEST_F(ModelStoreTest, AnAliasMovesAndGoesBack) {
  const std::string one = Add(1), two = Add(2), three = Add(3);
  EXPECT_EQ(Served(), "MODEL_NOT_FOUND");
  EXPECT_EQ(ReasonOf(Promote("models/m/versions/9").status()),
            "MODEL_NOT_FOUND");
  const auto first = Promote(one);
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(ReasonOf(stores_->models->Rollback(kAlias, "", kCaller).status()),
            "NOTHING_TO_ROLL_BACK");
  const auto second = Promote(two, first->etag());
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(Served(), two);
  EXPECT_EQ(ReasonOf(Promote(three, first->etag()).status()), "ETAG_MISMATCH");
  // A job that moved the alias and runs again after a crash.
  const auto again = Promote(two, first->etag());
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->etag(), second->etag());
  EXPECT_EQ(again->previous_version(), one);
  Reopen();
  EXPECT_EQ(Served(), two);
  EXPECT_EQ(
      ReasonOf(
          stores_->models->Rollback(kAlias, first->etag(), kCaller).status()),
      "ETAG_MISMATCH");
  const auto back = stores_->models->Rollback(kAlias, second->etag(), kCaller);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(Served(), one);
  EXPECT_NE(back->etag(), second->etag());
  EXPECT_NE(back->etag(), first->etag());
  const auto history = stores_->models->History(kAlias);
  ASSERT_EQ(history->size(), 3u);
  EXPECT_EQ(history->at(0).model_version(), one);
  EXPECT_TRUE(history->at(0).rollback());
  EXPECT_EQ(history->at(1).model_version(), two);
  EXPECT_EQ(history->at(2).requester(), kCaller.name);
  Reopen();
  EXPECT_EQ(Served(), one);
  for (const auto& status :
       {stores_->models->GetAlias("aliases/no").status(),
        stores_->models->History("aliases/no").status(),
        stores_->models->Rollback("aliases/no", "", kCaller).status()}) {
    EXPECT_EQ(ReasonOf(status), "ALIAS_NOT_FOUND");
  }
}

// An alias may hide a built-in model, and go back to it.
TEST_F(ModelStoreTest, TheDefaultGoesBackToTheBuiltInModel) {
  v1::PromoteSpec spec;
  spec.set_alias("aliases/default");
  spec.set_model_version(Add(1));
  ASSERT_TRUE(stores_->models->Promote(spec, true, kCaller).ok());
  EXPECT_TRUE(stores_->models->History("aliases/default")->front().forced());
  EXPECT_EQ(stores_->registry.Find("", "")->version_name,
            "models/m/versions/1");
  ASSERT_TRUE(stores_->models->Rollback("aliases/default", "", kCaller).ok());
  EXPECT_EQ(stores_->registry.Find("", "")->version_name,
            "models/default/versions/1");
}

TEST_F(ModelStoreTest, ACanaryGetsItsShareOfRobots) {
  const std::string one = Add(1), two = Add(2);
  ASSERT_TRUE(Promote(one).ok());
  v1::UpdateAliasRequest update;
  update.set_name(kAlias);
  update.mutable_canary()->set_model_version(two);
  for (const uint32_t wrong : {0u, 1001u}) {
    update.mutable_canary()->set_per_mille(wrong);
    EXPECT_EQ(ReasonOf(stores_->models->UpdateAlias(update, kCaller).status()),
              "INVALID_CONFIG");
  }
  for (const uint32_t per_mille : {1u, 50u, 333u, 1000u}) {
    update.mutable_canary()->set_per_mille(per_mille);
    ASSERT_TRUE(stores_->models->UpdateAlias(update, kCaller).ok());
    constexpr int kRobots = 20'000;
    int canaries = 0;
    for (int i = 0; i < kRobots; ++i) {
      const std::string robot = "robot-" + std::to_string(i);
      const bool canary = Served(robot.c_str()) == two;
      EXPECT_EQ(canary, Served(robot.c_str()) == two) << robot;
      canaries += canary ? 1 : 0;
    }
    const double p = per_mille / 1000.0;
    EXPECT_NEAR(canaries, kRobots * p, 4 * std::sqrt(kRobots * p * (1 - p)));
  }
  // Other aliases choose other robots.
  int both = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::string robot = std::to_string(i);
    both += IsCanary("a", robot, 500) && IsCanary("b", robot, 500) ? 1 : 0;
  }
  EXPECT_NEAR(both, 2500, 4 * std::sqrt(10'000 * 0.25 * 0.75));
  Reopen();
  EXPECT_EQ(Served("any"), two) << "1,000 of 1,000";
  ASSERT_TRUE(Promote(two).ok());
  EXPECT_FALSE(stores_->models->GetAlias(kAlias)->has_canary());
}

TEST_F(ModelStoreTest, TheHistoryOfAnAliasKeepsNoVersion) {
  const std::string one = Add(1), two = Add(2), three = Add(3);
  for (const std::string& name : {one, two, three}) {
    ASSERT_TRUE(Promote(name).ok());
  }
  EXPECT_TRUE(stores_->models->Delete(one, kCaller).ok());
  EXPECT_EQ(ReasonOf(stores_->models->Delete(two, kCaller)), "MODEL_IN_USE");
  EXPECT_EQ(stores_->models->History(kAlias)->back().model_version(), one);
}

// As a repeated request.
TEST_F(ModelStoreTest, AlsoMayLeaveTheAliasAsItIs) {
  const std::string one = Add(1), two = Add(2);
  ASSERT_TRUE(Promote(one).ok());
  v1::PromoteSpec spec;
  spec.set_alias(kAlias);
  spec.set_model_version(two);
  const auto alias = stores_->models->Promote(
      spec, false, kCaller, [](Transaction&) { return false; });
  ASSERT_TRUE(alias.ok()) << alias.status();
  EXPECT_EQ(alias->model_version(), one);
  EXPECT_EQ(Served(), one);
  EXPECT_EQ(stores_->models->History(kAlias)->size(), 1u);
}

TEST_F(ModelStoreTest, IsNotDeletedWhileAnAliasNamesIt) {
  const std::string one = Add(1), two = Add(2), three = Add(3);
  ASSERT_TRUE(Promote(one).ok());
  ASSERT_TRUE(Promote(two).ok());
  v1::UpdateAliasRequest update;
  update.set_name(kAlias);
  update.mutable_canary()->set_model_version(three);
  update.mutable_canary()->set_per_mille(1);
  ASSERT_TRUE(stores_->models->UpdateAlias(update, kCaller).ok());
  for (const std::string& name : {one, two, three}) {
    EXPECT_EQ(ReasonOf(stores_->models->Delete(name, kCaller)), "MODEL_IN_USE");
  }
  ASSERT_TRUE(Promote(three).ok());
  EXPECT_TRUE(stores_->models->Delete(one, kCaller).ok());
  EXPECT_EQ(ReasonOf(stores_->models->Delete(one, kCaller)), "MODEL_NOT_FOUND");
  EXPECT_EQ(ReasonOf(stores_->registry.Find(one, "").status()),
            "MODEL_NOT_FOUND");
  EXPECT_EQ(stores_->data->blobs().List()->size(), 2u);
}

TEST_F(ModelStoreTest, DeletingKeepsABundleThatAnotherVersionHas) {
  const std::string one = Add(1), same = Add(1);
  EXPECT_EQ(stores_->data->blobs().List()->size(), 1u);
  ASSERT_TRUE(stores_->models->Delete(one, kCaller).ok());
  EXPECT_TRUE(stores_->models->Bundle(*stores_->models->Get(same)).ok());
}

// A version is immutable: its name never means another bundle.
TEST_F(ModelStoreTest, ANumberIsNeverUsedAgain) {
  Add(1);
  const std::string two = Add(2);
  ASSERT_TRUE(stores_->models->Delete(two, kCaller).ok());
  EXPECT_EQ(Add(3), "models/m/versions/3");
  ASSERT_TRUE(stores_->models->Delete("models/m/versions/1", kCaller).ok());
  ASSERT_TRUE(stores_->models->Delete("models/m/versions/3", kCaller).ok());
  Reopen();
  EXPECT_EQ(Add(4), "models/m/versions/4");
}

TEST_F(ModelStoreTest, ADamagedBundleIsReportedAndNotServed) {
  const std::string one = Add(1), two = Add(2);
  ASSERT_TRUE(Promote(one).ok());
  const std::string path =
      stores_->data->blobs().PathOf(stores_->models->Get(one)->blob_sha256());
  stores_.reset();
  std::string bytes = ReadBytes(path);
  bytes[bytes.size() / 3] ^= 4;
  WriteBytes(path, bytes);
  auto data = *DataDirectory::Open(PosixFileSystem(), folder_ / "data");
  ModelRegistry registry;
  ModelStore models(data.get(), &registry, [] { return int64_t{1}; });
  const auto followed = models.Follow();
  ASSERT_TRUE(followed.ok()) << followed.status();
  EXPECT_THAT(models.failures(),
              ::testing::ElementsAre(::testing::HasSubstr(one)));
  EXPECT_TRUE(registry.Find(two, "").ok());
  EXPECT_FALSE(registry.Find("palm", "").ok());
}

}  // namespace
}  // namespace tactus::internal::server
