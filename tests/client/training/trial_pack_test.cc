#include "client/training/trial_pack.h"

#include "core/base/errors.h"
#include "gtest/gtest.h"
#include "tests/client/training/sample_trials.h"

namespace tactus::client {
namespace {

using testing::SampleTrials;

TEST(TrialPackTest, IsWhatTheContractSays) {
  const auto trials = SampleTrials(4);
  std::string pack;
  for (const Trial& trial : trials) {
    ASSERT_TRUE(AppendToPack(ToRecord(trial), &pack).ok());
  }
  EXPECT_EQ(pack, testing::PackOf(trials));
}

TEST(TrialPackTest, AnyPartsAddUp) {
  const auto trials = SampleTrials(4);
  const std::string pack = testing::PackOf(trials);
  for (size_t part = 1; part <= pack.size(); part = 2 * part + 1) {
    std::vector<std::string> ids;
    TrialUnpacker unpacker([&](const v1::TrialRecord& record) {
      ids.push_back(record.id());
      return absl::OkStatus();
    });
    for (size_t at = 0; at < pack.size(); at += part) {
      ASSERT_TRUE(unpacker.Add(absl::string_view(pack).substr(at, part)).ok());
    }
    EXPECT_TRUE(unpacker.Finish().ok());
    EXPECT_EQ(ids, (std::vector<std::string>{"100", "101", "102", "103"}));
    EXPECT_EQ(unpacker.records(), 4u);
  }
}

TEST(TrialPackTest, EveryEarlyEndIsNoticed) {
  const auto trials = SampleTrials(2);
  const std::string pack = testing::PackOf(trials);
  const size_t border = testing::PackOf({trials[0]}).size();
  for (size_t size = 0; size <= pack.size(); ++size) {
    TrialUnpacker unpacker(
        [](const v1::TrialRecord&) { return absl::OkStatus(); });
    ASSERT_TRUE(unpacker.Add(absl::string_view(pack).substr(0, size)).ok());
    EXPECT_EQ(unpacker.Finish().ok(),
              size == 0 || size == border || size == pack.size())
        << size;
  }
}

TEST(TrialPackTest, WrongBytesAreRefused) {
  for (const std::string& pack : {std::string(4, '\0'), std::string(4, '\xff'),
                                  std::string("\3\0\0\0\xff\xff\xff", 7)}) {
    TrialUnpacker unpacker(
        [](const v1::TrialRecord&) { return absl::OkStatus(); });
    EXPECT_EQ(ReasonOf(unpacker.Add(pack)), "INVALID_RESPONSE");
  }
}

TEST(TrialPackTest, TheSinksErrorEndsIt) {
  int calls = 0;
  TrialUnpacker unpacker([&](const v1::TrialRecord&) {
    ++calls;
    return absl::AbortedError("enough");
  });
  EXPECT_EQ(unpacker.Add(testing::PackOf(SampleTrials(3))).message(), "enough");
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace tactus::client
