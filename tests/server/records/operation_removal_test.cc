#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/records/stores.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using v1::Operation;

constexpr int64_t kDay = 24L * 3'600 * 1'000;

class OperationRemovalTest : public ::testing::Test {
 protected:
  OperationRemovalTest() : stores_(&PosixFileSystem(), folder_ / "data") {
    EXPECT_TRUE(stores_.datasets->Create(kDataset, "", kCaller).ok());
  }

  OperationStore Operations(const Retention& retention) {
    return OperationStore(
        stores_.data.get(), [this] { return stores_.time_ms; }, {}, retention);
  }
  // The name of a new operation in `state`.
  static std::string Add(OperationStore& operations, Operation::State state,
                         const Caller& caller = kCaller,
                         const std::string& id = "") {
    Operation operation;
    operation.set_kind(Operation::KIND_EVALUATE);
    operation.set_state(state);
    const auto added = operations.Create(operation, id, caller);
    EXPECT_TRUE(added.ok()) << added.status();
    return added->name();
  }
  static std::vector<std::string> Names(const OperationStore& operations) {
    std::vector<std::string> names;
    const auto page = operations.List(1'000, "", Operation::STATE_UNSPECIFIED);
    for (const Operation& operation : page->items) {
      names.push_back(operation.name());
    }
    return names;
  }
  size_t Entries(Table table) {
    size_t count = 0;
    EXPECT_TRUE(stores_.data->catalog()
                    .Look([&](const Transaction& look) -> absl::Status {
                      TACTUS_ASSIGN_OR_RETURN(const auto all,
                                              look.Scan(table, {}));
                      count = all.size();
                      return absl::OkStatus();
                    })
                    .ok());
    return count;
  }

  const ScratchDir folder_;
  Stores stores_;
};

TEST_F(OperationRemovalTest, NothingOfADeletedJobIsLeft) {
  OperationStore& operations = *stores_.operations;
  const std::string name =
      Add(operations, Operation::STATE_SUCCEEDED, kCaller, "once");
  ASSERT_TRUE(operations.AddPoints(name, {v1::LearningPoint()}).ok());
  ASSERT_TRUE(operations.SaveLog(name, v1::StoredLog()).ok());
  ASSERT_TRUE(operations.Delete(name, kCaller).ok());
  EXPECT_EQ(ReasonOf(operations.Get(name).status()), "OPERATION_NOT_FOUND");
  EXPECT_EQ(ReasonOf(operations.Delete(name, kCaller)), "OPERATION_NOT_FOUND");
  for (const Table table : {Table::kOperations, Table::kLearningPoints,
                            Table::kJobLogs, Table::kRequests}) {
    EXPECT_EQ(Entries(table), 0u) << static_cast<int>(table);
  }
  // Its name never means another job, and its request is a new one.
  EXPECT_NE(Add(operations, Operation::STATE_SUCCEEDED, kCaller, "once"), name);
}

TEST_F(OperationRemovalTest, AJobThatHasNotEndedStays) {
  OperationStore& operations = *stores_.operations;
  for (const auto state : {Operation::STATE_QUEUED, Operation::STATE_RUNNING,
                           Operation::STATE_CANCELLING}) {
    const std::string name = Add(operations, state);
    EXPECT_EQ(ReasonOf(operations.Delete(name, kCaller)), "OPERATION_ACTIVE");
    EXPECT_TRUE(operations.Get(name).ok());
  }
}

TEST_F(OperationRemovalTest, AClientLosesItsOwnOldestJobs) {
  OperationStore operations = Operations({.jobs = 2, .ms = 0});
  const Caller other = {"other", ""};
  const std::string kept = Add(operations, Operation::STATE_FAILED, other);
  const std::string active = Add(operations, Operation::STATE_QUEUED);
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) {
    names.push_back(Add(operations, Operation::STATE_SUCCEEDED));
  }
  EXPECT_THAT(Names(operations), ElementsAre(names[4], names[3], active, kept));
}

// A clock that is wrong by decades must not cost all.
TEST_F(OperationRemovalTest, AgeRemovesAllButTheNewestHundred) {
  OperationStore operations = Operations({.jobs = 0, .ms = 90 * kDay});
  std::vector<std::string> names;
  for (int i = 0; i < 102; ++i) {
    names.push_back(Add(operations, Operation::STATE_SUCCEEDED));
  }
  stores_.time_ms += 90 * kDay;
  EXPECT_EQ(*operations.RemoveOld(), 0);
  stores_.time_ms += 1;
  EXPECT_EQ(*operations.RemoveOld(), 2);
  EXPECT_EQ(*operations.RemoveOld(), 0);
  EXPECT_EQ(Names(operations).size(), 100u);
  EXPECT_EQ(Names(operations).back(), names[2]);
}

}  // namespace
}  // namespace tactus::internal::server
