// A result that named every trial that was left out grew with the dataset.
#include <fcntl.h>
#include <unistd.h>

#include <string>

#include "core/base/limits.h"
#include "core/data/trial_record.h"
#include "core/store/blob_store.h"
#include "gtest/gtest.h"
#include "server/trainer/job.h"
#include "tactus/v1/storage.pb.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"

namespace tactus::internal::server {
namespace {

constexpr int kUsable = 16;
constexpr int kUnusable = limits::kMaxNamedTrials + 5;

TEST(UnusableTrialsTest, AreCountedAndTheFirstAreNamed) {
  const ScratchDir folder;
  auto blobs = BlobStore::Open(PosixFileSystem(), folder / "blobs");
  ASSERT_TRUE(blobs.ok()) << blobs.status();
  BlobStore::Batch batch = (*blobs)->NewBatch();
  v1::JobSpec spec;
  for (int i = 0; i < kUsable + kUnusable; ++i) {
    Trial trial = testing::SmallTrial(i);
    // A model cannot learn from a trial without a label.
    if (i >= kUsable) trial.label.clear();
    const auto sha256 = batch.Add(ToRecord(trial).SerializeAsString());
    ASSERT_TRUE(sha256.ok()) << sha256.status();
    spec.add_trials(*sha256);
  }
  ASSERT_TRUE(batch.Commit().ok());
  spec.set_blob_folder(folder / "blobs");
  spec.set_dataset_sha256(std::string(64, 'a'));
  v1::Operation& operation = *spec.mutable_operation();
  operation.set_name("operations/1");
  operation.set_kind(v1::Operation::KIND_TRAIN);
  v1::TrainSpec& train = *operation.mutable_train();
  train.set_dataset_version("datasets/d/versions/1");
  train.set_preset("paper");
  train.set_networks(0);
  train.set_hmms_per_class(1);
  train.set_skip_unusable(true);
  std::filesystem::create_directory(folder / "job");
  std::filesystem::create_directory(folder / "job/parts");
  WriteBytes(folder / "job/job.pb", spec.SerializeAsString());
  const int null = open("/dev/null", O_WRONLY);
  LoneTeam alone;
  EventWriter events(null, &alone);
  FileJournal journal(PosixFileSystem(), folder / "job/parts", &events);
  const absl::Status status = RunJob(PosixFileSystem(), folder / "job",
                                     {.start = RunSerially, .run = RunSerially},
                                     &events, &journal, alone);
  close(null);
  ASSERT_TRUE(status.ok()) << status;
  v1::JobOutcome outcome;
  ASSERT_TRUE(outcome.ParseFromString(ReadBytes(folder / "job/result.pb")));
  ASSERT_TRUE(outcome.has_result()) << outcome.error().message();
  EXPECT_EQ(outcome.result().unusable(), static_cast<uint32_t>(kUnusable));
  EXPECT_EQ(outcome.result().unusable_trials_size(), limits::kMaxNamedTrials);
}

}  // namespace
}  // namespace tactus::internal::server
