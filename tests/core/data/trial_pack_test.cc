#include "core/data/trial_pack.h"

#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/limits.h"
#include "gtest/gtest.h"
#include "tests/support/small_trials.h"

namespace tactus::internal {
namespace {

using testing::Packed;
using testing::SmallTrial;

// Trials of different lengths.
std::vector<Trial> SomeTrials(int count) {
  std::vector<Trial> trials;
  for (int i = 0; i < count; ++i) trials.push_back(SmallTrial(i, 1 + 3 * i));
  return trials;
}

// The pack, put together without AppendToPack.
std::string PackOf(const std::vector<Trial>& trials) {
  std::string pack;
  for (const Trial& trial : trials) pack += Packed(trial);
  return pack;
}

TEST(TrialPackTest, IsWhatTheContractSays) {
  const auto trials = SomeTrials(4);
  std::string pack;
  for (const Trial& trial : trials) {
    ASSERT_TRUE(AppendToPack(ToRecord(trial), &pack).ok());
  }
  EXPECT_EQ(pack, PackOf(trials));
}

TEST(TrialPackTest, ARecordThatNoServerTakesIsNotPacked) {
  v1::TrialRecord record;
  record.set_taxels(std::string(limits::kMaxTrialRecordBytes, '\1'));
  std::string pack;
  EXPECT_EQ(ReasonOf(AppendToPack(record, &pack)), "INVALID_TRIAL");
  EXPECT_EQ(ReasonOf(AppendToPack({}, &pack)), "INVALID_TRIAL");
  EXPECT_TRUE(pack.empty());
}

TEST(TrialPackTest, AnyPartsAddUp) {
  const std::string pack = PackOf(SomeTrials(4));
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
    EXPECT_EQ(ids, (std::vector<std::string>{"trial-0", "trial-1", "trial-2",
                                             "trial-3"}));
    EXPECT_EQ(unpacker.records(), 4u);
  }
}

TEST(TrialPackTest, ASplitterSaysWhereEachByteLies) {
  const std::string pack = PackOf(SomeTrials(3));
  for (size_t size = 1; size <= pack.size(); size = 2 * size + 1) {
    PackSplitter splitter;
    std::string seen(pack.size(), '\0');
    int begun = 0;
    int ended = 0;
    for (size_t at = 0; at < pack.size(); at += size) {
      ASSERT_TRUE(splitter
                      .Add(
                          absl::string_view(pack).substr(at, size),
                          [&](uint32_t) {
                            ++begun;
                            return absl::OkStatus();
                          },
                          [&](const PackSplitter::Part& part) {
                            seen.replace(
                                static_cast<size_t>(part.record_at + part.at),
                                part.bytes.size(), part.bytes.data(),
                                part.bytes.size());
                            ended += part.is_last();
                            return absl::OkStatus();
                          })
                      .ok());
    }
    EXPECT_EQ(begun, 3);
    EXPECT_EQ(ended, 3);
    EXPECT_EQ(splitter.EndFault(), "");
    size_t at = 0;
    for (const Trial& trial : SomeTrials(3)) {
      const std::string record = ToRecord(trial).SerializeAsString();
      EXPECT_EQ(seen.substr(at + 4, record.size()), record);
      at += 4 + record.size();
    }
  }
}

TEST(TrialPackTest, EveryEarlyEndIsNoticed) {
  const auto trials = SomeTrials(2);
  const std::string pack = PackOf(trials);
  const size_t border = PackOf({trials[0]}).size();
  for (size_t size = 0; size <= pack.size(); ++size) {
    TrialUnpacker unpacker(
        [](const v1::TrialRecord&) { return absl::OkStatus(); });
    ASSERT_TRUE(unpacker.Add(absl::string_view(pack).substr(0, size)).ok());
    EXPECT_EQ(unpacker.Finish().ok(),
              size == 0 || size == border || size == pack.size())
        << size;
  }
}

// The last is one of unknown fields: nothing of a stranger is kept unseen.
TEST(TrialPackTest, WrongBytesAreRefused) {
  for (const std::string& pack :
       {std::string(4, '\0'), std::string(4, '\xff'),
        std::string("\3\0\0\0\xff\xff\xff", 7), Packed("\xf8\x7f\1")}) {
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
  EXPECT_EQ(unpacker.Add(PackOf(SomeTrials(3))).message(), "enough");
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace tactus::internal
