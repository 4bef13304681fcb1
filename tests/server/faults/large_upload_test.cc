// An upload of 256 MiB, and the memory that tactusd takes for it.
#include <chrono>

#include "client/training/training_client.h"
#include "client/training/trial_uploader.h"
#include "gtest/gtest.h"
#include "tests/support/child_tactusd.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"

namespace tactus::internal {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

// Trials of half a mebibyte each.
constexpr int kFrames = 16'384;

absl::StatusOr<v1::FinishUploadResponse> Upload(client::TrainingClient& client,
                                                int trials) {
  v1::CreateUploadRequest request;
  request.set_dataset("datasets/large");
  Trial trial = testing::SmallTrial(0, kFrames);
  int next = 0;
  client::TrialUploader uploader(&client, {});
  return uploader.Upload(request,
                         [&]() -> absl::StatusOr<std::optional<Trial>> {
                           if (next == trials) return std::nullopt;
                           // Each one differs.
                           trial.id = "trial-" + std::to_string(next);
                           trial.signals[0][0] = 1 + ++next;
                           return trial;
                         });
}

TEST(LargeUploadTest, TakesLessThan16MibOfMemory) {
  const ScratchDir folder;
  const testing::ChildTactusd server(
      {"--data-dir=" + (folder / "data"), "--log-level=warn"});
  ASSERT_NE(server.port(), 0) << server.Log();
  client::TrainingClient client(
      client::MakeTrainingChannel(server.address(), {}));
  ASSERT_TRUE(client.CreateDataset("datasets/large", "").ok());
  // What the server takes for any upload.
  const auto first = Upload(client, 1);
  ASSERT_TRUE(first.ok()) << first.status();
  server.ResetPeak();
  const double before = server.PeakMib();
  const auto begin = steady_clock::now();
  const auto made = Upload(client, 512);
  const double seconds = duration<double>(steady_clock::now() - begin).count();
  ASSERT_TRUE(made.ok()) << made.status();
  // The first one is among them.
  EXPECT_EQ(made->version().trials(), 512u);
  EXPECT_GE(made->version().bytes(), 256L << 20);
  const double growth = server.PeakMib() - before;
  std::printf("256 MiB in %.1f s; the server's memory grew by %.1f MiB\n",
              seconds, growth);
  RecordProperty("growth_kib", static_cast<int>(growth * 1024));
  EXPECT_TRUE(server.PeakIsBelow(before + 16));
}

}  // namespace
}  // namespace tactus::internal
