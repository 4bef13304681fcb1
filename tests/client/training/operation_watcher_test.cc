#include "client/training/operation_watcher.h"

#include <thread>

#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/training/fake_training_server.h"
#include "tests/client/training/sample_trials.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using testing::FakeTrainingServer;

constexpr char kName[] = "operations/7";

v1::Operation Job(v1::Operation::State state) {
  v1::Operation operation;
  operation.set_name(kName);
  operation.set_state(state);
  return operation;
}

v1::LearningPoint Point(uint32_t iteration) {
  v1::LearningPoint point;
  point.set_iteration(iteration);
  return point;
}

class OperationWatcherTest : public ::testing::Test {
 protected:
  OperationWatcherTest()
      : client_(server_.channel()), watcher_(&client_, testing::NoWaits()) {}

  absl::StatusOr<v1::Operation> Watch() {
    return watcher_.Watch(
        kName,
        [&](const v1::Operation&, std::span<const v1::LearningPoint> points) {
          ++updates_;
          for (const auto& point : points) {
            iterations_.push_back(point.iteration());
          }
        });
  }

  FakeTrainingServer server_;
  TrainingClient client_;
  OperationWatcher watcher_;
  int updates_ = 0;
  std::vector<uint32_t> iterations_;
};

TEST_F(OperationWatcherTest, ALateWatcherSeesTheWholeCurve) {
  server_.SetOperation(Job(v1::Operation::STATE_SUCCEEDED));
  for (uint32_t i = 1; i <= 3; ++i) server_.AddPoint(kName, Point(i));
  const auto ended = Watch();
  ASSERT_TRUE(ended.ok()) << ended.status();
  EXPECT_EQ(ended->state(), v1::Operation::STATE_SUCCEEDED);
  EXPECT_THAT(iterations_, ElementsAre(1, 2, 3));
}

TEST_F(OperationWatcherTest, HistoryIsFollowedByNews) {
  server_.SetOperation(Job(v1::Operation::STATE_RUNNING));
  server_.AddPoint(kName, Point(1));
  std::thread job([&] {
    server_.AwaitWatchers(1);
    server_.AddPoint(kName, Point(2));
    server_.AwaitWatchers(1);
    server_.AddPoint(kName, Point(3));
    server_.SetOperation(Job(v1::Operation::STATE_FAILED));
  });
  const auto ended = Watch();
  job.join();
  ASSERT_TRUE(ended.ok()) << ended.status();
  EXPECT_EQ(ended->state(), v1::Operation::STATE_FAILED);
  EXPECT_THAT(iterations_, ElementsAre(1, 2, 3));
  EXPECT_GE(updates_, 2);
}

TEST_F(OperationWatcherTest, ABrokenWatchContinuesWithoutRepetition) {
  server_.SetOperation(Job(v1::Operation::STATE_RUNNING));
  server_.AddPoint(kName, Point(1));
  server_.AddPoint(kName, Point(2));
  server_.BreakWatches(20);
  std::thread job([&] {
    server_.AwaitWatchers(1);
    server_.AddPoint(kName, Point(3));
    server_.SetOperation(Job(v1::Operation::STATE_SUCCEEDED));
  });
  const auto ended = Watch();
  job.join();
  ASSERT_TRUE(ended.ok()) << ended.status();
  EXPECT_THAT(iterations_, ElementsAre(1, 2, 3));
}

TEST_F(OperationWatcherTest, CancelEndsTheWatchAndNotTheJob) {
  server_.SetOperation(Job(v1::Operation::STATE_RUNNING));
  std::thread user([&] {
    server_.AwaitWatchers(1);
    watcher_.Cancel();
  });
  const auto ended = Watch();
  user.join();
  EXPECT_EQ(ended.status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(ReasonOf(ended.status()), "");
  EXPECT_EQ(server_.operation(kName).state(), v1::Operation::STATE_RUNNING);
  // A watch that begins later ends too.
  EXPECT_EQ(Watch().status().code(), absl::StatusCode::kCancelled);
}

TEST_F(OperationWatcherTest, AServerThatWasNeverThereIsReportedAtOnce) {
  server_.refuse = [](const std::string&) {
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
  };
  EXPECT_EQ(Watch().status().code(), absl::StatusCode::kUnavailable);
  server_.refuse = nullptr;
  EXPECT_EQ(ReasonOf(Watch().status()), "OPERATION_NOT_FOUND");
}

TEST_F(OperationWatcherTest, WrongAnswersAreRefused) {
  server_.SetOperation(Job(v1::Operation::STATE_SUCCEEDED));
  server_.alter = [](google::protobuf::Message& message) {
    dynamic_cast<v1::WatchOperationResponse&>(message)
        .mutable_operation()
        ->set_name("operations/8");
  };
  EXPECT_EQ(ReasonOf(Watch().status()), "INVALID_RESPONSE");
  // The end without a final state.
  server_.alter = [](google::protobuf::Message& message) {
    dynamic_cast<v1::WatchOperationResponse&>(message)
        .mutable_operation()
        ->set_state(v1::Operation::STATE_RUNNING);
  };
  EXPECT_EQ(ReasonOf(Watch().status()), "INVALID_RESPONSE");
}

}  // namespace
}  // namespace tactus::internal::client
