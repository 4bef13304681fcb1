#include "server/contact_log/record_ring.h"

#include <atomic>
#include <deque>
#include <iostream>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/record_frame.h"
#include "tests/server/contact_log/ring_records.h"
#include "tests/server/contact_log/watched_files.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kSegmentBytes = kRingBytes / 16;

class RecordRingTest : public ::testing::Test {
 protected:
  ScratchDir scratch_;
  const std::string folder_ = scratch_ / "ring";
};

TEST_F(RecordRingTest, ReadsWhatWasAppended) {
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->Ids(), IsEmpty());
  EXPECT_EQ(ring->first_id(), 1u);
  EXPECT_EQ(ring->next_id(), 1u);
  EXPECT_EQ(ring->bytes(), 0);
  const std::vector<size_t> sizes = {10'000, 0, 1, 40'000, 30'000};
  for (const size_t size : sizes) AppendNext(*ring, size);
  EXPECT_THAT(ring->Ids(), ElementsAre(1, 2, 3, 4, 5));
  for (size_t i = 0; i < sizes.size(); ++i) {
    ExpectRecord(*ring, i + 1, sizes[i]);
  }
  EXPECT_EQ(ring->first_id(), 1u);
  EXPECT_EQ(ring->next_id(), 6u);
  EXPECT_EQ(ring->bytes(), FolderBytes(folder_));
  for (const uint64_t id : {uint64_t{0}, uint64_t{6}, UINT64_MAX}) {
    ExpectNoRecord(*ring, id);
  }
  EXPECT_THAT(ring->damage(), IsEmpty());
}

TEST_F(RecordRingTest, ReadsTheOldestFirst) {
  const auto ring = OpenRing(folder_);
  for (int i = 0; i < 5; ++i) AppendNext(*ring, 30'000);
  std::vector<uint64_t> ids;
  const absl::Status status = ring->ForEach(
      [&](uint64_t id, absl::string_view record) {
        ids.push_back(id);
        EXPECT_TRUE(record == RecordBytes(id, 30'000));
      },
      [](uint64_t id, const absl::Status& error) {
        ADD_FAILURE() << id << ": " << error;
      });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(ids, ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(RecordRingTest, IdsGoOnAfterARestart) {
  for (uint64_t start = 0; start < 4; ++start) {
    const auto ring = OpenRing(folder_);
    EXPECT_THAT(ring->damage(), IsEmpty());
    ASSERT_EQ(ring->next_id(), 3 * start + 1);
    for (uint64_t id = 1; id <= 3 * start; ++id) ExpectRecord(*ring, id, id);
    for (int i = 0; i < 3; ++i) AppendNext(*ring, ring->next_id());
    EXPECT_EQ(ring->bytes(), FolderBytes(folder_));
  }
  // It makes no file before it has a record.
  const size_t files =
      std::distance(std::filesystem::directory_iterator(folder_), {});
  OpenRing(folder_);
  EXPECT_EQ(OpenRing(folder_)->next_id(), 13u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}),
            static_cast<ptrdiff_t>(files));
}

// Many small records: a segment has at most kSegmentIds of them.
TEST_F(RecordRingTest, KeepsManySmallRecords) {
  constexpr uint64_t kCount = 3 * kSegmentIds + 5;
  {
    const auto ring = OpenRing(folder_);
    for (uint64_t id = 1; id <= kCount; ++id) AppendNext(*ring, 3);
  }
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->damage(), IsEmpty());
  EXPECT_EQ(ring->Ids().size(), kCount);
  for (uint64_t id = 1; id <= kCount; ++id) ExpectRecord(*ring, id, 3);
}

TEST_F(RecordRingTest, RefusesARingThatIsTooSmall) {
  const absl::Status status =
      RecordRing::Open(folder_, kRingBytes - 1).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()), HasSubstr("1048575"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("at least 1048576"));
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(RecordRingTest, RefusesARecordThatIsTooLarge) {
  const auto ring = OpenRing(folder_);
  AppendNext(*ring, 10);
  const int64_t bytes = ring->bytes();
  const auto most = static_cast<size_t>(ring->max_record_bytes());
  EXPECT_GT(most, 65'000u);
  const absl::Status status = ring->Append(std::string(most + 1, 'x')).status();
  EXPECT_EQ(ReasonOf(status), "MESSAGE_TOO_LARGE");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr(std::to_string(most + 1)));
  EXPECT_EQ(ring->bytes(), bytes);
  EXPECT_EQ(FolderBytes(folder_), bytes);
  EXPECT_THAT(ring->Ids(), ElementsAre(1));
  const uint64_t id = AppendNext(*ring, most);
  ExpectRecord(*ring, id, most);
}

TEST_F(RecordRingTest, BelongsToOneRing) {
  auto ring = OpenRing(folder_);
  const absl::Status status = RecordRing::Open(folder_, kRingBytes).status();
  EXPECT_TRUE(DirectoryLock::IsInUse(status)) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(folder_));
  ring = nullptr;
  OpenRing(folder_);
}

TEST_F(RecordRingTest, NeedsAParentFolder) {
  EXPECT_EQ(
      ReasonOf(RecordRing::Open(scratch_ / "no/ring", kRingBytes).status()),
      "IO");
  WriteBytes(scratch_ / "file", "x");
  EXPECT_EQ(ReasonOf(RecordRing::Open(scratch_ / "file", kRingBytes).status()),
            "IO");
}

// Random sizes, with restarts: the folder is never larger than the ring, not
// even within one Append, and what was appended last is there.
TEST_F(RecordRingTest, NeverExceedsItsSizeAndKeepsTheNewest) {
  constexpr uint64_t kSeed = 20261201;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  WatchedFiles files(folder_);
  auto ring = OpenRing(folder_, kRingBytes, files);
  // By id, and what all that are newer have with their frames.
  std::deque<std::pair<uint64_t, size_t>> records;
  int64_t largest = 0;
  for (int i = 0; i < 2'000; ++i) {
    if (i % 200 == 199) {
      ring = nullptr;
      ring = OpenRing(folder_, kRingBytes, files);
      ASSERT_THAT(ring->damage(), IsEmpty());
    }
    const size_t most = random.Index(4) == 0 ? ring->max_record_bytes() : 9'000;
    const size_t size = random.Index(most + 1);
    records.emplace_back(AppendNext(*ring, size), size);
    largest = std::max(largest, static_cast<int64_t>(size));
    ASSERT_LE(FolderBytes(folder_), kRingBytes) << i;
    ASSERT_EQ(FolderBytes(folder_), ring->bytes()) << i;
    int64_t kept = 0;
    while (records.front().first < ring->first_id()) records.pop_front();
    ASSERT_EQ(records.front().first, ring->first_id());
    for (const auto& record : records) {
      kept += kFrameHeaderBytes + static_cast<int64_t>(record.second);
    }
    if (ring->first_id() > 1) {
      ASSERT_GE(kept, kRingBytes - 2 * kSegmentBytes - largest) << i;
    }
  }
  EXPECT_LE(files.most_bytes(), kRingBytes);
  EXPECT_GT(files.most_bytes(), kRingBytes - 2 * kSegmentBytes);
  ASSERT_EQ(ring->Ids().size(), records.size());
  for (const auto& [id, size] : records) ExpectRecord(*ring, id, size);
}

TEST_F(RecordRingTest, ShrinksWithTheNextAppend) {
  {
    const auto ring = OpenRing(folder_, 4 * kRingBytes);
    for (int i = 0; i < 60; ++i) AppendNext(*ring, 60'000);
    EXPECT_GT(ring->bytes(), 3 * kRingBytes);
  }
  const auto ring = OpenRing(folder_, kRingBytes);
  EXPECT_EQ(ring->Ids().size(), 60u) << "opening removes nothing";
  AppendNext(*ring, 100);
  EXPECT_LE(ring->bytes(), kRingBytes);
  EXPECT_GE(ring->bytes(), kRingBytes / 2);
  EXPECT_EQ(ring->bytes(), FolderBytes(folder_));
  for (const uint64_t id : ring->Ids()) {
    ExpectRecord(*ring, id, id == 61 ? 100 : 60'000);
  }
}

TEST_F(RecordRingTest, DropsTheOldest) {
  auto ring = OpenRing(folder_);
  EXPECT_FALSE(*ring->DropOldest());
  for (int i = 0; i < 4; ++i) AppendNext(*ring, 40'000);
  for (uint64_t id = 1; id <= 4; ++id) {
    EXPECT_EQ(ring->first_id(), id);
    const int64_t bytes = ring->bytes();
    EXPECT_TRUE(*ring->DropOldest());
    EXPECT_LE(ring->bytes(), bytes - 40'000);
    EXPECT_EQ(ring->bytes(), FolderBytes(folder_));
    ExpectNoRecord(*ring, id);
  }
  EXPECT_FALSE(*ring->DropOldest());
  EXPECT_THAT(ring->Ids(), IsEmpty());
  EXPECT_EQ(ring->first_id(), 5u);
  EXPECT_EQ(AppendNext(*ring, 7), 5u);
  ExpectRecord(*ring, 5, 7);
}

// Its ids are not given again, though no record is left that has them.
TEST_F(RecordRingTest, GivesNoIdTwiceAfterAllWereDropped) {
  uint64_t last = 0;
  for (int start = 0; start < 4; ++start) {
    const auto ring = OpenRing(folder_);
    EXPECT_THAT(ring->damage(), IsEmpty());
    // First those of the earlier ring, then its own.
    for (const int count : {0, 3}) {
      for (int i = 0; i < count; ++i) {
        EXPECT_GT(ring->next_id(), last);
        last = AppendNext(*ring, 1'000);
      }
      while (*ring->DropOldest()) {
      }
      EXPECT_THAT(ring->Ids(), IsEmpty());
    }
    if (start % 2 == 0) last = AppendNext(*ring, 1'000);
  }
  EXPECT_GT(OpenRing(folder_)->next_id(), last);
}

TEST_F(RecordRingTest, LeavesOtherFilesAlone) {
  OpenRing(folder_);
  const std::vector<std::string> names = {
      "notes.txt",        "000000000000001",  "00000000000000001",
      "000000000000000a", "0000000000000000", "9999999999999999"};
  for (const std::string& name : names) {
    WriteBytes(folder_ + "/" + name, std::string(2'000'000, 'x'));
  }
  const auto ring = OpenRing(folder_);
  EXPECT_EQ(ring->bytes(), 0);
  EXPECT_THAT(ring->damage(), IsEmpty());
  for (int i = 0; i < 40; ++i) AppendNext(*ring, 50'000);
  EXPECT_LE(ring->bytes(), kRingBytes);
  for (const std::string& name : names) {
    EXPECT_EQ(std::filesystem::file_size(folder_ + "/" + name), 2'000'000u);
  }
}

// Between a look into the index and the read of a file.
TEST_F(RecordRingTest, ARecordThatIsDroppedWhileItIsReadIsGone) {
  WatchedFiles files(folder_);
  const auto ring = OpenRing(folder_, kRingBytes, files);
  for (int i = 0; i < 3; ++i) AppendNext(*ring, 40'000);
  files.before_read = [&] { EXPECT_TRUE(*ring->DropOldest()); };
  // The file of the third is cut and not removed.
  for (const uint64_t id : {1, 2, 3}) ExpectNoRecord(*ring, id);
  for (int i = 0; i < 3; ++i) AppendNext(*ring, 40'000);
  const absl::Status all = ring->ForEach(
      [](uint64_t id, absl::string_view) { ADD_FAILURE() << id; },
      [](uint64_t, const absl::Status& error) { ADD_FAILURE() << error; });
  EXPECT_TRUE(all.ok()) << all;
  // Another record is where it was.
  const uint64_t last = AppendNext(*ring, 40'000);
  files.before_read = [&] {
    EXPECT_TRUE(*ring->DropOldest());
    AppendNext(*ring, 40'000);
  };
  ExpectNoRecord(*ring, last);
  files.before_read = [] {};
  ExpectRecord(*ring, last + 1, 40'000);
}

TEST_F(RecordRingTest, IsReadWhileItIsWritten) {
  constexpr uint64_t kSeed = 7;
  std::cout << "seed " << kSeed << "\n";
  const auto ring = OpenRing(folder_);
  constexpr size_t kSize = 5'000;
  std::atomic<bool> done = false;
  std::atomic<int> read = 0;
  std::vector<std::thread> readers;
  for (uint64_t reader = 0; reader < 3; ++reader) {
    readers.emplace_back([&, reader] {
      Random random = Random::ForStream(kSeed, reader);
      while (!done) {
        const std::vector<uint64_t> ids = ring->Ids();
        EXPECT_TRUE(std::ranges::is_sorted(ids));
        // In this order: both grow meanwhile.
        const uint64_t first = ring->first_id();
        EXPECT_LE(first, ring->next_id());
        EXPECT_LE(ring->bytes(), kRingBytes);
        if (ids.empty()) continue;
        // The oldest are the likeliest to go.
        const uint64_t id =
            random.Index(2) == 0 ? ids.front() : ids[random.Index(ids.size())];
        const auto record = ring->Read(id);
        if (record.ok()) {
          EXPECT_TRUE(*record == RecordBytes(id, kSize)) << id;
          ++read;
        } else {
          EXPECT_TRUE(absl::IsNotFound(record.status())) << record.status();
          EXPECT_LE(id, ring->next_id());
        }
        if (random.Index(100) == 0) {
          const absl::Status all = ring->ForEach(
              [&](uint64_t i, absl::string_view bytes) {
                EXPECT_TRUE(bytes == RecordBytes(i, kSize)) << i;
              },
              [](uint64_t, const absl::Status& error) {
                ADD_FAILURE() << error;
              });
          EXPECT_TRUE(all.ok()) << all;
        }
      }
    });
  }
  for (int i = 0; i < 3'000; ++i) {
    AppendNext(*ring, kSize);
    if (i % 500 == 499) {
      while (*ring->DropOldest()) {
      }
    }
    // On a machine with few cores they would not run meanwhile.
    if (i % 10 == 0) std::this_thread::yield();
  }
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_GT(read, 0);
}

}  // namespace
}  // namespace tactus::internal::server
