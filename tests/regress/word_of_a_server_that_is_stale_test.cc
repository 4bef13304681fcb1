// A server told others an older state than its own. So a promotion waited for a
// version that was served already. And health named a version that had been
// loaded since.
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "core/bundle/bundle.h"
#include "gmock/gmock.h"
#include "server/jobs/training_backend.h"
#include "server/registry/default_bundle.h"
#include "tests/server/replicas/shared_catalog.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"

namespace tactus::internal::server {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const Caller kDora = {"dora", "unix:"};

class StaleWordTest : public SharedCatalogTest {
 protected:
  // It is never started, so that it learns of changes only when it is asked
  // for one.
  std::unique_ptr<TrainingBackend> Open(ModelRegistry* registry) {
    EXPECT_TRUE(registry->AddBuiltIn("default", DefaultBundle()).ok());
    auto backend = TrainingBackend::Open({.folder = folder_ / "shared",
                                          .shared = {.catalog = address_,
                                                     .address = "here:1",
                                                     .pace = kQuickPace},
                                          .runs_jobs = false},
                                         registry);
    EXPECT_TRUE(backend.ok()) << backend.status();
    return *std::move(backend);
  }
  static absl::StatusOr<v1::ModelVersion> Add(TrainingBackend& backend) {
    return backend.models().AddVersion("models/m",
                                       *EncodeBundle(testing::SmallModel()),
                                       v1::ModelVersion(), kDora);
  }
  static absl::StatusOr<v1::Alias> Promote(TrainingBackend& backend,
                                           const std::string& version) {
    v1::PromoteSpec spec;
    spec.set_alias("aliases/arm");
    spec.set_model_version(version);
    return backend.models().Promote(spec, false, kDora);
  }
  // What the record of a server says.
  static uint64_t ServedBy(Replica& replica) {
    const auto all = replica.All();
    EXPECT_TRUE(all.ok()) << all.status();
    for (const Replica::Seen& seen : *all) {
      if (seen.is_this) return seen.about.served_change();
    }
    return 0;
  }

  ScratchDir folder_;
};

// Two threads of a server follow two changes, and the earlier one speaks last.
TEST_F(StaleWordTest, ServedChangesNeverGoBack) {
  const auto replica = Join();
  for (uint64_t change = 2; change <= 60; change += 2) {
    std::thread earlier(
        [&] { EXPECT_TRUE(replica->SayServed(change - 1).ok()); });
    EXPECT_TRUE(replica->SayServed(change).ok());
    earlier.join();
    ASSERT_EQ(ServedBy(*replica), change);
  }
}

// A server that follows because it is asked for a change says so, even if it
// then refuses the change.
TEST_F(StaleWordTest, ARefusedChangeLeavesNobodyWaiting) {
  ModelRegistry first, second;
  const auto a = Open(&first);
  const auto b = Open(&second);
  const auto version = Add(*a);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_FALSE(b->models().Rollback("aliases/none", "", kDora).ok());
  EXPECT_TRUE(second.Find(version->name(), "").ok());
  EXPECT_EQ(ServedBy(*a->replica()), 1u);
  EXPECT_EQ(ServedBy(*b->replica()), 1u);
}

TEST_F(StaleWordTest, AVersionThatCanBeLoadedAgainIsNoFailure) {
  ModelRegistry first, second;
  const auto a = Open(&first);
  const auto version = Add(*a);
  ASSERT_TRUE(version.ok()) << version.status();
  const std::string path = a->data().blobs().PathOf(version->blob_sha256());
  std::filesystem::rename(path, path + ".away");
  const auto b = Open(&second);
  EXPECT_THAT(b->failures(), SizeIs(1));
  std::filesystem::rename(path + ".away", path);
  ASSERT_TRUE(Promote(*b, version->name()).ok());
  EXPECT_THAT(b->failures(), IsEmpty());
}

}  // namespace
}  // namespace tactus::internal::server
