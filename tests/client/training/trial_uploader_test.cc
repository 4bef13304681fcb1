#include "client/training/trial_uploader.h"

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"

namespace tactus::internal::client {
namespace {

using testing::FakeTrainingServer;
using testing::From;
using ::testing::HasSubstr;
using testing::SampleTrials;

constexpr char kDataset[] = "datasets/arm";

class TrialUploaderTest : public ::testing::Test {
 protected:
  TrialUploaderTest() : client_(server_.channel()) {
    EXPECT_TRUE(client_.CreateDataset(kDataset, "").ok());
    options_.chunk_bytes = 64;
    options_.call_bytes = 256;
    options_.ahead_bytes = 128;
    options_.retry = testing::NoWaits();
  }

  absl::StatusOr<v1::FinishUploadResponse> Upload(const std::string& id) {
    v1::CreateUploadRequest request;
    request.set_dataset(kDataset);
    request.set_request_id(id);
    request.set_replace(true);
    return TrialUploader(&client_, options_).Upload(request, From(trials_));
  }

  const std::vector<Trial> trials_ = SampleTrials(6);
  const std::string pack_ = testing::PackOf(trials_);
  FakeTrainingServer server_;
  TrainingClient client_;
  UploadOptions options_;
};

TEST_F(TrialUploaderTest, EveryByteArrives) {
  std::vector<int64_t> progress;
  options_.on_progress = [&](int64_t bytes, uint64_t) {
    progress.push_back(bytes);
  };
  const auto made = Upload("a");
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->version().name(), "datasets/arm/versions/1");
  EXPECT_EQ(server_.PackOf(kDataset), pack_);
  EXPECT_EQ(server_.bytes_received(), static_cast<int64_t>(pack_.size()));
  EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
  EXPECT_EQ(progress.back(), static_cast<int64_t>(pack_.size()));
}

TEST_F(TrialUploaderTest, NoTrialsAreAnEmptyUpload) {
  v1::CreateUploadRequest request;
  request.set_dataset(kDataset);
  const auto made = TrialUploader(&client_, options_).Upload(request, From({}));
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->version().trials(), 0u);
  EXPECT_EQ(server_.write_calls(), 0);
}

TEST_F(TrialUploaderTest, TrialsAreTakenWhenTheyAreNeeded) {
  const auto many = SampleTrials(30);
  size_t longest = 0;
  for (const Trial& trial : many) {
    longest = std::max(longest, testing::PackOf({trial}).size());
  }
  size_t next = 0;
  size_t taken = 0;
  v1::CreateUploadRequest request;
  request.set_dataset(kDataset);
  const auto made =
      TrialUploader(&client_, options_)
          .Upload(request, [&]() -> absl::StatusOr<std::optional<Trial>> {
            // A call may have begun without the server's notice.
            const size_t calls = server_.write_calls() + 1;
            EXPECT_LE(taken, calls * (options_.call_bytes + 64) +
                                 options_.ahead_bytes + 64 + longest);
            if (next == many.size()) return std::nullopt;
            taken += testing::PackOf({many[next]}).size();
            return many[next++];
          });
  EXPECT_TRUE(made.ok()) << made.status();
  EXPECT_GT(taken, 10 * (options_.call_bytes + longest));
}

TEST_F(TrialUploaderTest, AnInterruptionAtEveryChunkIsSurvived) {
  int number = 0;
  const auto size = static_cast<int64_t>(pack_.size());
  ASSERT_GT(size, 20 * 64);
  for (const auto kept :
       {FakeTrainingServer::Kept::kNone, FakeTrainingServer::Kept::kHalf,
        FakeTrainingServer::Kept::kAll}) {
    for (int64_t at = 0; at <= size; at += 64) {
      const int64_t before = server_.bytes_received();
      server_.BreakUploadAt(at, kept);
      const auto made = Upload(std::to_string(++number));
      ASSERT_TRUE(made.ok()) << made.status();
      ASSERT_EQ(server_.PackOf(kDataset), pack_) << at;
      // Only one call's bytes are sent twice.
      EXPECT_LE(server_.bytes_received() - before, size + 256) << at;
    }
  }
}

TEST_F(TrialUploaderTest, AnotherProgramContinues) {
  server_.refuse = [&](const std::string& method) {
    return method == "WriteUpload" && server_.bytes_received() > 512
               ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone")
               : grpc::Status::OK;
  };
  EXPECT_EQ(Upload("a").status().code(), absl::StatusCode::kUnavailable);
  const int64_t before = server_.bytes_received();
  ASSERT_LT(before, static_cast<int64_t>(pack_.size()));
  server_.refuse = nullptr;
  options_.chunk_bytes = 100;  // borders elsewhere
  const auto made = Upload("a");
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(server_.PackOf(kDataset), pack_);
  EXPECT_EQ(server_.bytes_received(), static_cast<int64_t>(pack_.size()));

  // What is finished is not sent again.
  const auto again = Upload("a");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->version().name(), made->version().name());
  EXPECT_EQ(server_.bytes_received(), static_cast<int64_t>(pack_.size()));
}

TEST_F(TrialUploaderTest, ItGivesUpAfterManyFailuresInARow) {
  int writes = 0;
  server_.refuse = [&](const std::string& method) {
    if (method != "WriteUpload") return grpc::Status::OK;
    ++writes;
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  };
  const auto made = Upload("a");
  EXPECT_EQ(made.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(writes, options_.retry.limit + 1);
}

TEST_F(TrialUploaderTest, AMissingServerIsReportedAtOnce) {
  server_.refuse = [&](const std::string&) {
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  };
  options_.retry.sleep = [](std::chrono::milliseconds) { FAIL(); };
  EXPECT_EQ(Upload("a").status().code(), absl::StatusCode::kUnavailable);
}

TEST_F(TrialUploaderTest, FinishIsRepeated) {
  int calls = 0;
  server_.refuse = [&](const std::string& method) {
    return method == "FinishUpload" && ++calls < 4
               ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone")
               : grpc::Status::OK;
  };
  EXPECT_TRUE(Upload("a").ok());
  EXPECT_EQ(calls, 4);
}

TEST_F(TrialUploaderTest, TheServersReasonIsReturned) {
  v1::CreateUploadRequest request;
  request.set_dataset("datasets/none");
  TrialUploader uploader(&client_, options_);
  EXPECT_EQ(ReasonOf(uploader.Upload(request, From(trials_)).status()),
            "DATASET_NOT_FOUND");
  // A trial that the server refuses.
  std::vector<Trial> bad = trials_;
  bad[3].time[2] = bad[3].time[1];
  request.set_dataset(kDataset);
  const auto refused = uploader.Upload(request, From(bad));
  EXPECT_EQ(ReasonOf(refused.status()), "INVALID_TRIAL");
  EXPECT_THAT(std::string(refused.status().message()),
              HasSubstr("trial 103: time: entry 2"));
}

TEST_F(TrialUploaderTest, TheErrorOfTheTrialsEndsIt) {
  v1::CreateUploadRequest request;
  request.set_dataset(kDataset);
  int calls = 0;
  const auto made =
      TrialUploader(&client_, options_)
          .Upload(request, [&]() -> absl::StatusOr<std::optional<Trial>> {
            if (++calls > 3) {
              return IoError("a.h5", "damaged");
            }
            return trials_[calls];
          });
  EXPECT_EQ(ReasonOf(made.status()), "IO");
}

TEST_F(TrialUploaderTest, WrongAnswersAreRefused) {
  struct Case {
    const char* what;
    std::function<void(google::protobuf::Message&)> alter;
  };
  const auto write = [](int64_t change) {
    return [change](google::protobuf::Message& message) {
      if (auto* m = dynamic_cast<v1::WriteUploadResponse*>(&message)) {
        m->set_committed_size(m->committed_size() + change);
      }
    };
  };
  const Case cases[] = {
      {"committed_size", write(1)},
      {"committed_size", write(-1)},
      {"upload",
       [](google::protobuf::Message& message) {
         if (auto* m = dynamic_cast<v1::CreateUploadResponse*>(&message)) {
           m->clear_upload();
         }
       }},
      {"committed_size",
       [](google::protobuf::Message& message) {
         if (auto* m = dynamic_cast<v1::CreateUploadResponse*>(&message)) {
           m->set_committed_size(-5);
         }
       }},
      {"committed_size",
       [](google::protobuf::Message& message) {
         if (auto* m = dynamic_cast<v1::CreateUploadResponse*>(&message)) {
           m->set_committed_size(1 << 30);
         }
       }},
      {"version.name",
       [](google::protobuf::Message& message) {
         if (auto* m = dynamic_cast<v1::FinishUploadResponse*>(&message)) {
           m->clear_version();
         }
       }},
  };
  int number = 0;
  for (const Case& wrong : cases) {
    server_.alter = wrong.alter;
    const auto made = Upload(std::to_string(++number));
    EXPECT_EQ(ReasonOf(made.status()), "INVALID_RESPONSE") << number;
    EXPECT_THAT(std::string(made.status().message()), HasSubstr(wrong.what));
  }
  // A server that forgets bytes which it has confirmed.
  server_.alter = [](google::protobuf::Message& message) {
    if (auto* m = dynamic_cast<v1::QueryWriteStatusResponse*>(&message)) {
      m->set_committed_size(0);
    }
  };
  server_.BreakUploadAt(600, FakeTrainingServer::Kept::kAll);
  EXPECT_EQ(ReasonOf(Upload("x").status()), "INVALID_RESPONSE");
}

}  // namespace
}  // namespace tactus::internal::client
