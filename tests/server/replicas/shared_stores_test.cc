// What servers of one catalogue promise each other.
#include <atomic>

#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "gmock/gmock.h"
#include "server/jobs/training_backend.h"
#include "server/registry/default_bundle.h"
#include "tests/server/replicas/shared_catalog.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Caller kAnn = {"ann", "unix:"};

// A server without its sockets.
struct Server {
  ModelRegistry registry;
  std::unique_ptr<TrainingBackend> backend;
};

class SharedStoresTest : public SharedCatalogTest {
 protected:
  std::unique_ptr<Server> Start() {
    auto server = std::make_unique<Server>();
    EXPECT_TRUE(server->registry.AddBuiltIn("default", DefaultBundle()).ok());
    auto backend = TrainingBackend::Open({.folder = folder_ / "shared",
                                          .shared = {.catalog = address_,
                                                     .address = "here:1",
                                                     .pace = kQuickPace},
                                          .runs_jobs = false},
                                         &server->registry);
    EXPECT_TRUE(backend.ok()) << backend.status();
    server->backend = *std::move(backend);
    server->backend->Start();
    return server;
  }

  static absl::Status Write(Server& server, const std::string& upload,
                            const std::string& pack, size_t end) {
    TACTUS_ASSIGN_OR_RETURN(const auto writer,
                            server.backend->uploads().Write(upload, kAnn));
    const auto begin = static_cast<size_t>(writer->committed_size());
    const std::string part = pack.substr(begin, end - begin);
    TACTUS_RETURN_IF_ERROR(writer->Append(static_cast<int64_t>(begin), part,
                                          ExtendCrc32c(0, part)));
    return writer->Commit();
  }
  static absl::StatusOr<v1::DatasetVersion> Finish(Server& server,
                                                   const std::string& upload,
                                                   const std::string& pack) {
    uint32_t known = 0;
    return server.backend->uploads().Finish(
        upload, static_cast<int64_t>(pack.size()), ExtendCrc32c(0, pack), kAnn,
        &known);
  }
  static std::string Bundle(uint64_t seed) {
    Model model = testing::SmallModel();
    model.provenance.seed = seed;
    return *EncodeBundle(model);
  }

  ScratchDir folder_;
};

TEST_F(SharedStoresTest, AnUploadGoesOnAtAnotherServer) {
  const auto a = Start();
  const auto b = Start();
  ASSERT_TRUE(a->backend->datasets().Create("datasets/d", "", kAnn).ok());
  const std::string pack = testing::SmallPack(0, 8, 3);
  const auto upload =
      a->backend->uploads().Create("datasets/d", "r", false, kAnn);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_TRUE(Write(*a, upload->name(), pack, pack.size() / 2).ok());
  // The same request at another server is the same upload.
  const auto again =
      b->backend->uploads().Create("datasets/d", "r", false, kAnn);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->name(), upload->name());
  EXPECT_EQ(again->committed_size(), static_cast<int64_t>(pack.size() / 2));
  ASSERT_TRUE(Write(*b, upload->name(), pack, pack.size()).ok());
  const auto version = Finish(*a, upload->name(), pack);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->trials(), 8u);
  EXPECT_EQ(Finish(*b, upload->name(), pack)->name(), version->name());
}

TEST_F(SharedStoresTest, AnUploadIsHeldByOneServer) {
  const auto a = Start();
  const auto b = Start();
  ASSERT_TRUE(a->backend->datasets().Create("datasets/d", "", kAnn).ok());
  const auto upload =
      a->backend->uploads().Create("datasets/d", "", false, kAnn);
  const auto held = a->backend->uploads().Write(upload->name(), kAnn);
  ASSERT_TRUE(held.ok()) << held.status();
  EXPECT_EQ(
      ReasonOf(b->backend->uploads().Write(upload->name(), kAnn).status()),
      "UPLOAD_BUSY");
}

// A server that was taken for dead still writes to the upload that another one
// goes on with: what was committed stays, and what it adds does not count.
TEST_F(SharedStoresTest, ASlowServerDoesNotHarmAnUpload) {
  const auto slow = Start();
  const auto b = Start();
  ASSERT_TRUE(slow->backend->datasets().Create("datasets/d", "", kAnn).ok());
  const std::string pack = testing::SmallPack(0, 8, 3);
  const auto upload =
      slow->backend->uploads().Create("datasets/d", "", false, kAnn);
  const auto writer = slow->backend->uploads().Write(upload->name(), kAnn);
  ASSERT_TRUE(writer.ok()) << writer.status();
  const size_t half = pack.size() / 2;
  const std::string part = pack.substr(0, half);
  ASSERT_TRUE((*writer)->Append(0, part, ExtendCrc32c(0, part)).ok());
  ASSERT_TRUE((*writer)->Commit().ok());
  slow->backend->replica()->Stop();
  std::unique_ptr<UploadStore::Writer> next;
  ASSERT_TRUE(Eventually([&] {
    auto taken = b->backend->uploads().Write(upload->name(), kAnn);
    if (taken.ok()) next = *std::move(taken);
    return taken.ok();
  }));
  EXPECT_EQ(next->committed_size(), static_cast<int64_t>(half));
  ASSERT_TRUE((*writer)
                  ->Append(static_cast<int64_t>(half), "stray",
                           ExtendCrc32c(0, "stray"))
                  .ok());
  const absl::Status late = (*writer)->Commit();
  EXPECT_TRUE(absl::IsAborted(late)) << late;
  next.reset();
  ASSERT_TRUE(Write(*b, upload->name(), pack, pack.size()).ok());
  const auto version = Finish(*b, upload->name(), pack);
  ASSERT_TRUE(version.ok()) << version.status();
  EXPECT_EQ(version->trials(), 8u);
}

// Two servers make versions of one dataset at once: each builds on the one
// before, and none is lost.
TEST_F(SharedStoresTest, NoVersionIsLost) {
  constexpr int kEach = 4;
  const auto a = Start();
  const auto b = Start();
  ASSERT_TRUE(a->backend->datasets().Create("datasets/d", "", kAnn).ok());
  std::vector<std::thread> threads;
  for (int s = 0; s < 2; ++s) {
    threads.emplace_back([&, s] {
      Server& server = s == 0 ? *a : *b;
      for (int i = 0; i < kEach; ++i) {
        const int first = 10 * (s * kEach + i);
        const std::string pack = testing::SmallPack(first, first + 3, 3);
        const auto upload =
            server.backend->uploads().Create("datasets/d", "", false, kAnn);
        ASSERT_TRUE(upload.ok()) << upload.status();
        ASSERT_TRUE(Write(server, upload->name(), pack, pack.size()).ok());
        const auto made = Finish(server, upload->name(), pack);
        EXPECT_TRUE(made.ok()) << made.status();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto latest = a->backend->datasets().Version("datasets/d");
  ASSERT_TRUE(latest.ok()) << latest.status();
  EXPECT_EQ(latest->name(), "datasets/d/versions/8");
  EXPECT_EQ(latest->trials(), 24u);
  const auto trials = b->backend->datasets().Trials(*latest);
  ASSERT_TRUE(trials.ok()) << trials.status();
  for (const v1::TrialInfo& trial : *trials) {
    EXPECT_TRUE(b->backend->data().blobs().Read(trial.sha256(), 1 << 20).ok());
  }
}

// When a promotion has returned, new streams of each server get the version.
TEST_F(SharedStoresTest, APromotionIsServedEverywhere) {
  const auto a = Start();
  const auto b = Start();
  const auto c = Start();
  ASSERT_TRUE(Eventually([&] {
    return IsAlive(*a->backend->replica(), "replicas/2") &&
           IsAlive(*a->backend->replica(), "replicas/3");
  }));
  for (uint32_t i = 1; i <= 5; ++i) {
    Server& server = i % 2 == 0 ? *a : *b;
    const auto version = server.backend->models().AddVersion(
        "models/m", Bundle(i), v1::ModelVersion(), kAnn);
    ASSERT_TRUE(version.ok()) << version.status();
    v1::PromoteSpec spec;
    spec.set_alias("aliases/arm");
    spec.set_model_version(version->name());
    Server& other = i % 2 == 0 ? *b : *c;
    const auto moved = other.backend->models().Promote(spec, false, kAnn);
    ASSERT_TRUE(moved.ok()) << moved.status();
    EXPECT_THAT(moved->lagging_replicas(), IsEmpty());
    for (Server* const each : {a.get(), b.get(), c.get()}) {
      const auto found = each->registry.Find("arm", "robot");
      ASSERT_TRUE(found.ok()) << found.status();
      EXPECT_EQ(found->version_name, version->name());
    }
  }
  const auto back = c->backend->models().Rollback("aliases/arm", "", kAnn);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(a->registry.Find("arm", "robot")->version_name,
            "models/m/versions/4");
}

TEST_F(SharedStoresTest, AServerThatIsSilentIsNamed) {
  const auto a = Start();
  const auto b = Start();
  ASSERT_TRUE(Eventually(
      [&] { return IsAlive(*a->backend->replica(), "replicas/2"); }));
  const auto version = a->backend->models().AddVersion(
      "models/m", Bundle(1), v1::ModelVersion(), kAnn);
  ASSERT_TRUE(version.ok()) << version.status();
  // It lives, and hears nothing.
  v1::StoredReplica deaf;
  deaf.set_address("there:1");
  auto replica = Replica::Register(catalog_.get(), deaf, kQuickPace);
  ASSERT_TRUE(replica.ok());
  (*replica)->Start([](bool) {});
  ASSERT_TRUE(Eventually(
      [&] { return IsAlive(*a->backend->replica(), "replicas/3"); }));
  v1::PromoteSpec spec;
  spec.set_alias("aliases/arm");
  spec.set_model_version(version->name());
  const auto moved = a->backend->models().Promote(spec, false, kAnn);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_THAT(moved->lagging_replicas(), ElementsAre("replicas/3"));
}

// A server that cannot read a bundle does not say that it serves it.
TEST_F(SharedStoresTest, AServerThatCannotLoadAVersionIsNamed) {
  const auto a = Start();
  const auto version = a->backend->models().AddVersion(
      "models/m", Bundle(1), v1::ModelVersion(), kAnn);
  ASSERT_TRUE(version.ok()) << version.status();
  const std::string path =
      a->backend->data().blobs().PathOf(version->blob_sha256());
  std::filesystem::rename(path, path + ".away");
  const auto b = Start();
  v1::PromoteSpec spec;
  spec.set_alias("aliases/arm");
  spec.set_model_version(version->name());
  const auto moved = a->backend->models().Promote(spec, false, kAnn);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_THAT(moved->lagging_replicas(), ElementsAre("replicas/2"));
  // It tries again with the next change.
  std::filesystem::rename(path + ".away", path);
  ASSERT_TRUE(a->backend->datasets().Create("datasets/d", "", kAnn).ok());
  EXPECT_TRUE(Eventually([&] { return b->registry.Find("arm", "x").ok(); }));
}

TEST_F(SharedStoresTest, AnotherFolderIsRefused) {
  const auto a = Start();
  ASSERT_TRUE(a->backend->datasets().Create("datasets/d", "", kAnn).ok());
  std::filesystem::create_directories(folder_ / "other");
  WriteBytes(folder_ / "other/marker", std::string(32, 'a') + " 1\n");
  ModelRegistry registry;
  const auto wrong = TrainingBackend::Open(
      {.folder = folder_ / "other", .shared = {.catalog = address_}},
      &registry);
  EXPECT_EQ(ReasonOf(wrong.status()), "DATA_LOST") << wrong.status();
}

}  // namespace
}  // namespace tactus::internal::server
