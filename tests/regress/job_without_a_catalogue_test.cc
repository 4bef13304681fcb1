// A job that began just when the database went away failed with
// CATALOG_UNAVAILABLE, although nothing was wrong with it.
#include <sys/stat.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "core/base/crc32c.h"
#include "core/base/random.h"
#include "core/bundle/bundle.h"
#include "gtest/gtest.h"
#include "server/jobs/training_backend.h"
#include "server/registry/default_bundle.h"
#include "tests/server/replicas/shared_catalog.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;

const Caller kCarl = {"carl", "unix:"};

class JobWithoutACatalogueTest : public SharedCatalogTest {
 protected:
  // A server whose trainer, a script, has its result at once.
  void Start() {
    WriteBytes(folder_ / "bundle", *EncodeBundle(testing::SmallModel()));
    v1::JobOutcome outcome;
    outcome.mutable_result();
    WriteBytes(folder_ / "result", outcome.SerializeAsString());
    const std::string trainer = folder_ / "trainer";
    WriteBytes(trainer, "#!/bin/sh\ncp " + folder_.path() +
                            "/bundle $1/bundle.tactus\ncp " + folder_.path() +
                            "/result $1/result.pb\n");
    chmod(trainer.c_str(), 0755);
    ASSERT_TRUE(registry_.AddBuiltIn("default", DefaultBundle()).ok());
    auto backend =
        TrainingBackend::Open({.folder = folder_ / "shared",
                               .shared = {.catalog = address_,
                                          .address = "here:1",
                                          .pace = kQuickPace},
                               .jobs = {.process = {.program = trainer}}},
                              &registry_);
    ASSERT_TRUE(backend.ok()) << backend.status();
    backend_ = *std::move(backend);
    backend_->Start();
  }
  void Upload() {
    ASSERT_TRUE(backend_->datasets().Create("datasets/d", "", kCarl).ok());
    const std::string pack = testing::SmallPack(0, 2, 3);
    const auto upload =
        backend_->uploads().Create("datasets/d", "", false, kCarl);
    ASSERT_TRUE(upload.ok()) << upload.status();
    {
      const auto writer = backend_->uploads().Write(upload->name(), kCarl);
      ASSERT_TRUE(writer.ok()) << writer.status();
      ASSERT_TRUE((*writer)->Append(0, pack, ExtendCrc32c(0, pack)).ok());
      ASSERT_TRUE((*writer)->Commit().ok());
    }
    uint32_t known = 0;
    const auto version = backend_->uploads().Finish(
        upload->name(), static_cast<int64_t>(pack.size()),
        ExtendCrc32c(0, pack), kCarl, &known);
    ASSERT_TRUE(version.ok()) << version.status();
  }
  std::string Request() {
    v1::Operation request;
    request.set_kind(v1::Operation::KIND_TRAIN);
    request.mutable_train()->set_dataset_version("datasets/d/versions/1");
    request.mutable_train()->set_model("models/m");
    const auto operation = backend_->operations().Create(request, "", kCarl);
    EXPECT_TRUE(operation.ok()) << operation.status();
    backend_->jobs().Wake();
    return operation.ok() ? operation->name() : "";
  }

  ScratchDir folder_;
  ModelRegistry registry_;
  std::unique_ptr<TrainingBackend> backend_;
};

TEST_F(JobWithoutACatalogueTest, GoesOnWhenItIsBack) {
  constexpr uint64_t kSeed = 5;
  std::printf("seed %d\n", static_cast<int>(kSeed));
  Random random(kSeed);
  Start();
  Upload();
  std::vector<std::string> jobs;
  for (int i = 0; i < 60; ++i) jobs.push_back(Request());
  for (int i = 0; i < 6; ++i) {
    std::this_thread::sleep_for(milliseconds(100 + random.Index(300)));
    server_->Kill();
    server_->Start();
  }
  for (const std::string& name : jobs) {
    for (int i = 0; i < 1'200; ++i) {
      const auto operation = backend_->operations().Get(name);
      if (operation.ok() && HasEnded(*operation)) break;
      std::this_thread::sleep_for(milliseconds(50));
    }
    const auto operation = backend_->operations().Get(name);
    ASSERT_TRUE(operation.ok()) << operation.status();
    EXPECT_EQ(operation->state(), v1::Operation::STATE_SUCCEEDED)
        << operation->ShortDebugString();
  }
  // One version of each.
  const auto versions = backend_->models().List("models/m", 100, "");
  ASSERT_TRUE(versions.ok()) << versions.status();
  EXPECT_EQ(versions->items.size(), jobs.size());
}

}  // namespace
}  // namespace tactus::internal::server
