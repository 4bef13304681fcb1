// Crashes at each operation on the disk, and disks that fail once.
#include <filesystem>
#include <functional>
#include <map>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

namespace fs = std::filesystem;
using testing::CrashFileSystem;
using testing::CrashVfs;
using Loss = CrashFileSystem::Loss;

// What is known of the steps that returned OK, by name.
using Acknowledged = std::map<std::string, std::string>;

struct Scenario {
  // Before the crash; on a sound disk.
  std::function<void(Stores&)> prepare;
  // Does its steps until one fails.
  std::function<absl::Status(Stores&, Acknowledged&)> work;
  // After the crash.
  std::function<void(Stores&, const Acknowledged&)> check;
};

class CrashTest : public ::testing::Test {
 protected:
  void Prepare(const Scenario& scenario) {
    {
      Stores stores(&PosixFileSystem(), folder_ / "base");
      scenario.prepare(stores);
    }
    // It is large, and copied for each crash.
    fs::remove(folder_ / "base/reserve");
  }
  std::string Copy() {
    const std::string path = folder_ / "data";
    fs::remove_all(path);
    fs::copy(folder_ / "base", path, fs::copy_options::recursive);
    return path;
  }

  // Stops at every operation, with every loss; then reopens.
  void CrashEverywhere(const Scenario& scenario, int at_least) {
    Prepare(scenario);
    int points = 0;
    for (const Loss loss : CrashFileSystem::kLosses) {
      bool reached = true;
      for (int k = 1; reached && !HasFailure(); ++k) {
        SCOPED_TRACE("loss " + std::to_string(static_cast<int>(loss)) +
                     ", operation " + std::to_string(k));
        CrashFileSystem files;
        const CrashVfs vfs(&files);
        const std::string path = Copy();
        Acknowledged acknowledged;
        {
          Stores stores(&files, path, vfs.name());
          files.Lose(Loss::kNothing);
          files.StopAt(k);
          EXPECT_TRUE(scenario.work(stores, acknowledged).ok() ||
                      files.failed());
          reached = files.failed();
        }
        files.Lose(loss);
        files.Heal();
        Stores stores(&files, path, vfs.name());
        ASSERT_NE(stores.data, nullptr);
        scenario.check(stores, acknowledged);
        // The work can be done now, or go on.
        Acknowledged again;
        const absl::Status status = scenario.work(stores, again);
        EXPECT_TRUE(status.ok()) << status;
        scenario.check(stores, again);
        ++points;
      }
    }
    RecordProperty("points", points);
    std::printf("%d crash points\n", points);
    EXPECT_GE(points, at_least);
  }

  // Fails each operation once, then goes on.
  void FailEverywhere(const Scenario& scenario, int at_least) {
    Prepare(scenario);
    int points = 0;
    for (const absl::Status& error :
         {StorageFull("disk", "no room"), IoError("disk", "error")}) {
      bool reached = true;
      for (int n = 1; reached && !HasFailure(); ++n) {
        SCOPED_TRACE("operation " + std::to_string(n) + " fails with " +
                     std::string(error.message()));
        CrashFileSystem files;
        const CrashVfs vfs(&files);
        Stores stores(&files, Copy(), vfs.name());
        Acknowledged acknowledged;
        files.FailAt(n, error);
        const absl::Status status = scenario.work(stores, acknowledged);
        reached = files.failed();
        files.Heal();
        if (!status.ok()) {
          EXPECT_EQ(ReasonOf(status), ReasonOf(error)) << status;
        }
        scenario.check(stores, acknowledged);
        Acknowledged again;
        const absl::Status second = scenario.work(stores, again);
        EXPECT_TRUE(second.ok()) << second;
        scenario.check(stores, again);
        ++points;
      }
    }
    RecordProperty("points", points);
    std::printf("%d failed operations\n", points);
    EXPECT_GE(points, at_least);
  }

  ScratchDir folder_;
};

// Every version can be read whole, and the newest has the sizes that it says.
void CheckDatasets(Stores& stores) {
  const auto datasets = stores.datasets->List(100, "");
  ASSERT_TRUE(datasets.ok()) << datasets.status();
  for (const v1::Dataset& dataset : datasets->items) {
    const auto history = stores.datasets->GetHistory(dataset.name());
    ASSERT_TRUE(history.ok()) << history.status();
    EXPECT_EQ(history->versions.size(), dataset.latest_version());
    for (const v1::DatasetVersion& version : history->versions) {
      const auto trials = stores.datasets->Trials(version);
      ASSERT_TRUE(trials.ok()) << trials.status();
      EXPECT_EQ(trials->size(), version.trials());
      for (const v1::TrialInfo& trial : *trials) {
        const auto bytes =
            stores.data->blobs().Read(trial.sha256(), trial.bytes());
        EXPECT_TRUE(bytes.ok()) << bytes.status();
      }
    }
  }
}

const std::string& ThePack() {
  static const std::string pack = Pack(1, 4);
  return pack;
}

// Create, write in chunks, commit each, finish.
const Scenario kUpload = {
    .prepare =
        [](Stores& stores) {
          ASSERT_TRUE(stores.datasets->Create(kDataset, "", kCaller).ok());
          ASSERT_TRUE(stores.Upload(Pack(0, 2)).ok());
        },
    .work = [](Stores& stores, Acknowledged& acknowledged) -> absl::Status {
      TACTUS_ASSIGN_OR_RETURN(
          const auto upload,
          stores.uploads->Create(kDataset, "request", false, kCaller));
      acknowledged["upload"] = upload.name();
      if (upload.dataset_version().empty()) {
        TACTUS_ASSIGN_OR_RETURN(const auto writer,
                                stores.uploads->Write(upload.name(), kCaller));
        auto done = static_cast<size_t>(writer->committed_size());
        acknowledged["size"] = std::to_string(done);
        while (done < ThePack().size()) {
          const std::string chunk = ThePack().substr(done, 150);
          TACTUS_RETURN_IF_ERROR(writer->Append(static_cast<int64_t>(done),
                                                chunk, ExtendCrc32c(0, chunk)));
          TACTUS_RETURN_IF_ERROR(writer->Commit());
          done += chunk.size();
          acknowledged["size"] = std::to_string(done);
        }
      }
      TACTUS_ASSIGN_OR_RETURN(const auto version,
                              stores.Finish(upload.name(), ThePack()));
      acknowledged["version"] = version.sha256();
      return absl::OkStatus();
    },
    .check =
        [](Stores& stores, const Acknowledged& acknowledged) {
          CheckDatasets(stores);
          const auto dataset = stores.datasets->Get(kDataset);
          ASSERT_TRUE(dataset.ok()) << dataset.status();
          EXPECT_TRUE(dataset->latest_version() == 1 ||
                      dataset->latest_version() == 2);
          const auto newest = stores.datasets->Version(kDataset);
          ASSERT_TRUE(newest.ok()) << newest.status();
          EXPECT_EQ(newest->trials(), dataset->latest_version() == 1 ? 2u : 4u);
          if (acknowledged.contains("version")) {
            EXPECT_EQ(newest->sha256(), acknowledged.at("version"));
          }
          if (acknowledged.contains("size")) {
            const auto upload = stores.uploads->Get(acknowledged.at("upload"));
            ASSERT_TRUE(upload.ok()) << upload.status();
            const int64_t size = upload->committed_size();
            EXPECT_GE(size, std::stol(acknowledged.at("size")));
            if (upload->dataset_version().empty() && size > 0) {
              const auto bytes = stores.data->files().Read(
                  stores.data->UploadPath("2"), 0, size);
              ASSERT_TRUE(bytes.ok()) << bytes.status();
              EXPECT_EQ(*bytes, ThePack().substr(0, static_cast<size_t>(size)));
            }
          }
        }};

TEST_F(CrashTest, UploadSurvivesACrash) { CrashEverywhere(kUpload, 140); }
TEST_F(CrashTest, UploadSurvivesAFailedOperation) {
  FailEverywhere(kUpload, 70);
}

// Publish a version, then let the alias name it.
const Scenario kPublish = {
    .prepare =
        [](Stores& stores) {
          v1::PromoteSpec spec;
          spec.set_alias("aliases/best");
          spec.set_model_version("models/m/versions/1");
          ASSERT_TRUE(
              stores.models->AddVersion("models/m", TestBundle(1), {}, kCaller)
                  .ok());
          ASSERT_TRUE(stores.models->Promote(spec, false, kCaller).ok());
        },
    .work = [](Stores& stores, Acknowledged& acknowledged) -> absl::Status {
      v1::ModelVersion origin;
      origin.set_operation("operations/1");
      TACTUS_ASSIGN_OR_RETURN(const auto version,
                              stores.models->AddVersion(
                                  "models/m", TestBundle(2), origin, kCaller));
      acknowledged["version"] = version.name();
      v1::PromoteSpec spec;
      spec.set_alias("aliases/best");
      spec.set_model_version(version.name());
      TACTUS_RETURN_IF_ERROR(
          stores.models->Promote(spec, false, kCaller).status());
      acknowledged["alias"] = version.name();
      return absl::OkStatus();
    },
    .check =
        [](Stores& stores, const Acknowledged& acknowledged) {
          const auto page = stores.models->List("models/m", 10, "");
          ASSERT_TRUE(page.ok()) << page.status();
          ASSERT_GE(page->items.size(), 1u);
          ASSERT_LE(page->items.size(), 2u);
          for (const v1::ModelVersion& version : page->items) {
            const auto bundle = stores.models->Bundle(version);
            ASSERT_TRUE(bundle.ok()) << bundle.status();
            EXPECT_EQ(*bundle, TestBundle(version.name().back() - '0'));
          }
          const auto alias = stores.models->GetAlias("aliases/best");
          ASSERT_TRUE(alias.ok()) << alias.status();
          const auto history = stores.models->History("aliases/best");
          ASSERT_TRUE(history.ok()) << history.status();
          EXPECT_EQ(history->front().model_version(), alias->model_version());
          EXPECT_EQ(history->size(),
                    alias->model_version() == "models/m/versions/2" ? 2u : 1u);
          // Streams get what the catalogue says.
          EXPECT_EQ(stores.registry.Find("best", "")->version_name,
                    alias->model_version());
          if (acknowledged.contains("version")) {
            EXPECT_EQ(page->items.size(), 2u);
          }
          if (acknowledged.contains("alias")) {
            EXPECT_EQ(alias->model_version(), acknowledged.at("alias"));
          }
        }};

TEST_F(CrashTest, PublishAndAliasSurviveACrash) {
  CrashEverywhere(kPublish, 50);
}
TEST_F(CrashTest, PublishAndAliasSurviveAFailedOperation) {
  FailEverywhere(kPublish, 25);
}

// Request a job, run it, let it learn, end it.
const Scenario kOperation = {
    .prepare = [](Stores&) {},
    .work = [](Stores& stores, Acknowledged& acknowledged) -> absl::Status {
      v1::Operation request;
      request.set_kind(v1::Operation::KIND_TRAIN);
      TACTUS_ASSIGN_OR_RETURN(
          const auto operation,
          stores.operations->Create(request, "request", kCaller));
      acknowledged["name"] = operation.name();
      for (const auto state :
           {v1::Operation::STATE_RUNNING, v1::Operation::STATE_SUCCEEDED}) {
        const auto changed = stores.operations->Change(
            operation.name(), [&](v1::Operation& job) {
              if (!HasEnded(job)) job.set_state(state);
              return absl::OkStatus();
            });
        TACTUS_RETURN_IF_ERROR(changed.status());
        acknowledged["state"] = std::to_string(changed->state());
        if (state != v1::Operation::STATE_RUNNING) continue;
        TACTUS_ASSIGN_OR_RETURN(const auto known,
                                stores.operations->Points(operation.name()));
        if (!known.empty()) continue;
        TACTUS_RETURN_IF_ERROR(stores.operations->AddPoints(
            operation.name(), std::vector<v1::LearningPoint>(3)));
        acknowledged["points"] = "3";
      }
      return absl::OkStatus();
    },
    .check =
        [](Stores& stores, const Acknowledged& acknowledged) {
          const auto page =
              stores.operations->List(10, "", v1::Operation::STATE_UNSPECIFIED);
          ASSERT_TRUE(page.ok()) << page.status();
          ASSERT_LE(page->items.size(), 1u);
          if (!acknowledged.contains("name")) return;
          const auto operation =
              stores.operations->Get(acknowledged.at("name"));
          ASSERT_TRUE(operation.ok()) << operation.status();
          const auto points = stores.operations->Points(operation->name());
          EXPECT_TRUE(points->empty() || points->size() == 3);
          if (acknowledged.contains("points")) {
            EXPECT_EQ(points->size(), 3u);
          }
          if (acknowledged.contains("state") &&
              acknowledged.at("state") ==
                  std::to_string(v1::Operation::STATE_SUCCEEDED)) {
            EXPECT_EQ(operation->state(), v1::Operation::STATE_SUCCEEDED);
          }
        }};

TEST_F(CrashTest, OperationsSurviveACrash) { CrashEverywhere(kOperation, 60); }
TEST_F(CrashTest, OperationsSurviveAFailedOperation) {
  FailEverywhere(kOperation, 30);
}

}  // namespace
}  // namespace tactus::internal::server
