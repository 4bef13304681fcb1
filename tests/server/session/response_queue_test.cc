#include "server/session/response_queue.h"

#include "core/base/limits.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

// Sequences of the answers that wait, in order of writing.
std::vector<uint64_t> Drain(ResponseQueue& queue) {
  std::vector<uint64_t> sequences;
  while (const auto* response = queue.StartWrite(0)) {
    sequences.push_back(response->answer().sequence());
    queue.FinishWrite();
  }
  return sequences;
}

TEST(ResponseQueueTest, KeepsAllInterimsOfOneRequest) {
  ResponseQueue queue;
  queue.BeginRequest();
  for (int i = 1; i <= 5; ++i) queue.AddInterim()->set_sequence(i);
  EXPECT_EQ(Drain(queue), (std::vector<uint64_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(queue.superseded(), 0u);
}

TEST(ResponseQueueTest, NewRequestSupersedesWaitingInterimsOnly) {
  ResponseQueue queue;
  queue.BeginRequest();
  queue.AddMessage()->mutable_started();
  queue.AddInterim()->set_sequence(1);
  queue.AddKept()->set_sequence(2);
  queue.AddInterim()->set_sequence(3);
  queue.BeginRequest();
  v1::Answer* newest = queue.AddInterim();
  newest->set_sequence(4);
  EXPECT_EQ(newest->superseded(), 2u);
  EXPECT_EQ(queue.superseded(), 2u);
  ASSERT_TRUE(queue.StartWrite(0)->has_started());
  queue.FinishWrite();
  EXPECT_EQ(Drain(queue), (std::vector<uint64_t>{2, 4}));
}

TEST(ResponseQueueTest, SaysHowLongAnAnswerWaited) {
  ResponseQueue queue;
  queue.BeginRequest();
  queue.AddKept();
  queue.EndRequest(/*elapsed_ns=*/10, /*now_ns=*/1000);
  ASSERT_NE(queue.StartWrite(1500), nullptr);
  EXPECT_EQ(queue.waited_ns(), 500);
  queue.FinishWrite();
  // The final of a half-close belongs to no message; the entry is used again.
  queue.BeginRequest();
  queue.AddKept();
  ASSERT_NE(queue.StartWrite(9000), nullptr);
  EXPECT_EQ(queue.waited_ns(), 0);
}

TEST(ResponseQueueTest, TheOneBeingWrittenStaysAsItIs) {
  ResponseQueue queue;
  queue.BeginRequest();
  queue.AddInterim()->set_sequence(1);
  const auto* writing = queue.StartWrite(0);
  for (int i = 2; i < 50; ++i) {
    queue.BeginRequest();
    queue.AddInterim()->set_sequence(i);
    EXPECT_EQ(queue.StartWrite(0), nullptr);
    EXPECT_EQ(writing->answer().sequence(), 1u);
    EXPECT_EQ(queue.size(), 1u);
  }
  queue.FinishWrite();
  EXPECT_EQ(Drain(queue), (std::vector<uint64_t>{49}));
  EXPECT_TRUE(queue.empty());
}

TEST(ResponseQueueTest, IsFullOfKeptAnswersNotOfInterims) {
  ResponseQueue queue;
  queue.BeginRequest();
  for (size_t i = 0; i < limits::kMaxQueuedKept - 1; ++i) {
    queue.AddKept();
    queue.AddInterim();
  }
  EXPECT_FALSE(queue.full());
  queue.AddKept();
  EXPECT_TRUE(queue.full());
  // The first in line is a kept one.
  ASSERT_NE(queue.StartWrite(0), nullptr);
  EXPECT_FALSE(queue.full());
}

TEST(ResponseQueueTest, DividesComputeTimeAndReportsWaitingTime) {
  ResponseQueue queue;
  queue.BeginRequest();
  queue.EndRequest(100, 1000);  // Brought nothing.
  queue.BeginRequest();
  queue.AddInterim()->mutable_diagnostics();
  queue.AddInterim();
  queue.AddInterim()->mutable_diagnostics();
  queue.EndRequest(500, 2000);
  const auto* response = queue.StartWrite(2050);
  EXPECT_EQ(response->answer().diagnostics().server_compute_ns(), 200);
  EXPECT_EQ(response->answer().diagnostics().queue_ns(), 50);
  queue.FinishWrite();
  // Who did not ask gets no times.
  EXPECT_FALSE(queue.StartWrite(2100)->answer().has_diagnostics());
  queue.FinishWrite();
  response = queue.StartWrite(2300);
  EXPECT_EQ(response->answer().diagnostics().server_compute_ns(), 200);
  EXPECT_EQ(response->answer().diagnostics().queue_ns(), 300);
}

}  // namespace
}  // namespace tactus::internal::server
