#include "server/records/operation_store.h"

#include <thread>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using v1::Operation;

class OperationStoreTest : public ::testing::Test {
 protected:
  void Reopen() {
    stores_.reset();
    stores_ = std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data");
  }
  OperationStore& operations() { return *stores_->operations; }
  std::string Create(const std::string& id = "") {
    Operation request;
    request.set_kind(Operation::KIND_TRAIN);
    const auto operation = operations().Create(request, id, kCaller);
    EXPECT_TRUE(operation.ok()) << operation.status();
    return operation->name();
  }
  void Set(const std::string& name, Operation::State state) {
    EXPECT_TRUE(operations()
                    .Change(name,
                            [&](Operation& job) {
                              job.set_state(state);
                              return absl::OkStatus();
                            })
                    .ok());
  }
  static v1::LearningPoint Point(uint32_t iteration) {
    v1::LearningPoint point;
    point.set_iteration(iteration);
    return point;
  }

  ScratchDir folder_;
  std::unique_ptr<Stores> stores_ =
      std::make_unique<Stores>(&PosixFileSystem(), folder_ / "data");
};

TEST_F(OperationStoreTest, ARequestIdGivesOneOperation) {
  const std::string name = Create("id");
  EXPECT_EQ(name, "operations/1");
  EXPECT_EQ(Create("id"), name);
  EXPECT_EQ(Create("other"), "operations/2");
  Reopen();
  EXPECT_EQ(Create("id"), name);
  EXPECT_EQ(operations().Get(name)->requester(), kCaller.name);
  EXPECT_EQ(operations().Get(name)->request_id(), "id");
  EXPECT_EQ(operations().Get(name)->state(), Operation::STATE_QUEUED);
  EXPECT_EQ(ReasonOf(operations().Get("operations/9").status()),
            "OPERATION_NOT_FOUND");
}

TEST_F(OperationStoreTest, ListsTheNewestFirstInPages) {
  for (int i = 0; i < 12; ++i) Create();
  for (const int i : {2, 5, 11}) {
    Set("operations/" + std::to_string(i), Operation::STATE_FAILED);
  }
  for (const auto& [state, count] :
       {std::pair(Operation::STATE_UNSPECIFIED, 12),
        std::pair(Operation::STATE_FAILED, 3)}) {
    for (const int size : {1, 2, 3, 12, 50}) {
      std::vector<int> numbers;
      std::string token;
      do {
        const auto page = operations().List(size, token, state);
        ASSERT_TRUE(page.ok());
        EXPECT_LE(page->items.size(), static_cast<size_t>(size));
        for (const Operation& job : page->items) {
          numbers.push_back(std::stoi(job.name().substr(11)));
        }
        token = page->next_token;
      } while (!token.empty());
      EXPECT_EQ(numbers.size(), static_cast<size_t>(count));
      EXPECT_TRUE(std::is_sorted(numbers.rbegin(), numbers.rend()));
    }
  }
  EXPECT_EQ(operations().InStates({Operation::STATE_FAILED})->size(), 3u);
}

TEST_F(OperationStoreTest, StatesAfterARestart) {
  const Operation::State before[] = {
      Operation::STATE_QUEUED,     Operation::STATE_RUNNING,
      Operation::STATE_CANCELLING, Operation::STATE_SUCCEEDED,
      Operation::STATE_FAILED,     Operation::STATE_CANCELLED};
  for (const Operation::State state : before) Set(Create(), state);
  Reopen();
  std::vector<Operation::State> after;
  for (int i = 1; i <= 6; ++i) {
    after.push_back(
        operations().Get("operations/" + std::to_string(i))->state());
  }
  EXPECT_THAT(
      after, ElementsAre(Operation::STATE_QUEUED, Operation::STATE_QUEUED,
                         Operation::STATE_CANCELLED, Operation::STATE_SUCCEEDED,
                         Operation::STATE_FAILED, Operation::STATE_CANCELLED));
}

TEST_F(OperationStoreTest, EachClientHasItsOwnRequestIds) {
  const Caller others[] = {
      {"b", ""}, {"tester/x", ""}, {"1:tester", ""}, {"", ""}};
  const auto first = operations().Create({}, "x/y", kCaller);
  ASSERT_TRUE(first.ok());
  for (const Caller& other : others) {
    for (const char* id : {"x/y", "y", "/x/y"}) {
      const auto made = operations().Create({}, id, other);
      EXPECT_NE(made->name(), first->name()) << other.name << " " << id;
      EXPECT_EQ(made->requester(), other.name);
      EXPECT_EQ(operations().Create({}, id, other)->name(), made->name());
    }
  }
  EXPECT_EQ(operations().Create({}, "x/y", kCaller)->name(), first->name());
  EXPECT_EQ((*operations().Find("x/y", kCaller))->name(), first->name());
  EXPECT_FALSE(operations().Find("z", kCaller)->has_value());
}

TEST_F(OperationStoreTest, TheQueueIsBounded) {
  for (int i = 0; i < limits::kMaxQueuedJobs; ++i) Create();
  EXPECT_EQ(ReasonOf(operations().Create({}, "", kCaller).status()),
            "JOB_LIMIT");
  // What has ended already does not wait.
  Operation ended;
  ended.set_state(Operation::STATE_SUCCEEDED);
  EXPECT_TRUE(operations().Create(ended, "", kCaller).ok());
  Set("operations/1", Operation::STATE_CANCELLED);
  Create();
}

TEST_F(OperationStoreTest, AFailedChangeChangesNothing) {
  const std::string name = Create();
  const auto changed = operations().Change(name, [](Operation& job) {
    job.set_state(Operation::STATE_FAILED);
    return IoError("a", "b");
  });
  EXPECT_EQ(ReasonOf(changed.status()), "IO");
  EXPECT_EQ(operations().Get(name)->state(), Operation::STATE_QUEUED);
}

TEST_F(OperationStoreTest, ALateWatcherSeesTheWholeCurve) {
  const std::string name = Create();
  ASSERT_TRUE(operations().AddPoints(name, {Point(1), Point(2)}).ok());
  ASSERT_TRUE(operations().AddPoints(name, {Point(3)}).ok());
  Reopen();
  ASSERT_TRUE(operations().AddPoints(name, {Point(4)}).ok());
  OperationStore::Cursor cursor;
  auto update = operations().WaitForChange(name, &cursor, milliseconds(0));
  ASSERT_TRUE(update.ok()) << update.status();
  ASSERT_EQ(update->points.size(), 4u);
  for (uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(update->points[i].iteration(), i + 1);
  }
  update = operations().WaitForChange(name, &cursor, milliseconds(0));
  EXPECT_TRUE(update->points.empty());
  // News from another thread end the wait.
  std::thread other(
      [&] { ASSERT_TRUE(operations().AddPoints(name, {Point(5)}).ok()); });
  do {
    update = operations().WaitForChange(name, &cursor, milliseconds(60'000));
  } while (update->points.empty());
  other.join();
  EXPECT_EQ(update->points.front().iteration(), 5u);
  operations().StopWaiting();
  EXPECT_TRUE(
      operations().WaitForChange(name, &cursor, milliseconds(60'000)).ok());
}

TEST_F(OperationStoreTest, ProgressIsShownUntilTheEnd) {
  const std::string name = Create();
  v1::OperationProgress progress;
  progress.set_phase("train");
  operations().ShowProgress(name, progress);
  EXPECT_EQ(operations().Get(name)->progress().phase(), "train");
  Set(name, Operation::STATE_SUCCEEDED);
  EXPECT_EQ(operations().Get(name)->progress().phase(), "");
}

}  // namespace
}  // namespace tactus::internal::server
