// File: small_job.h
//
// SmallJob: folders of a small training, for tactus-trainer.
//
//   SmallJob job;
//   job.spec().mutable_operation()->mutable_train()->set_epochs(2);
//   const std::string folder = job.New("first");
//
// Not thread-safe.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "core/base/random.h"
#include "core/data/trial_record.h"
#include "core/store/blob_store.h"
#include "gtest/gtest.h"
#include "tactus/v1/storage.pb.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::testing {

// A push whose force, area and motion depend on the label.
inline Trial PushTrial(int number) {
  Random random(static_cast<uint64_t>(number) + 1);
  Trial trial;
  trial.id = "push-" + std::to_string(number);
  const bool hard = number % 2 == 0;
  const bool moves = number / 2 % 2 == 0;
  trial.label = std::string(hard ? "H" : "S") + (moves ? "M" : "U");
  trial.condition = "c" + std::to_string(number % 3);
  const double scale = 1 + 0.2 * random.Uniform();
  for (int f = 0; f < 100; ++f) {
    const double t = 0.01 * f;
    trial.time.push_back(t);
    const double noise = 1 + 0.1 * random.Uniform();
    trial.signals.push_back(
        {scale * noise * (hard ? 8 : 2) * (0.1 + std::sqrt(t)),
         scale * noise * (hard ? 2e-4 : 8e-4) * (0.2 + t),
         (moves ? 0.02 * scale : 1e-4) * t * t});
  }
  return trial;
}

class SmallJob {
 public:
  SmallJob() {
    auto blobs = BlobStore::Open(PosixFileSystem(), folder_ / "blobs");
    EXPECT_TRUE(blobs.ok()) << blobs.status();
    BlobStore::Batch batch = (*blobs)->NewBatch();
    for (int i = 0; i < 24; ++i) {
      const auto sha256 = batch.Add(ToRecord(PushTrial(i)).SerializeAsString());
      EXPECT_TRUE(sha256.ok()) << sha256.status();
      spec_.add_trials(*sha256);
    }
    EXPECT_TRUE(batch.Commit().ok());
    spec_.set_blob_folder(folder_ / "blobs");
    spec_.set_dataset_sha256(std::string(64, 'a'));
    v1::Operation& operation = *spec_.mutable_operation();
    operation.set_name("operations/1");
    operation.set_kind(v1::Operation::KIND_TRAIN);
    operation.mutable_train()->set_dataset_version("datasets/d/versions/1");
    operation.mutable_train()->set_networks(1);
    operation.mutable_train()->set_epochs(5);
    operation.mutable_train()->set_hmms_per_class(1);
  }

  // Writes the job to a new folder of that name.
  std::string New(const std::string& name) {
    const std::string folder = folder_ / name;
    std::filesystem::create_directory(folder);
    WriteBytes(folder + "/job.pb", spec_.SerializeAsString());
    return folder;
  }
  std::string Path(const std::string& name) const { return folder_ / name; }
  v1::JobSpec& spec() { return spec_; }

 private:
  ScratchDir folder_;
  v1::JobSpec spec_;
};

}  // namespace tactus::internal::testing
