// Rings whose files were cut, changed, or put there by somebody else.
#include <sys/stat.h>

#include <cstring>
#include <functional>
#include <map>
#include <vector>

#include "core/base/crc32c.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/record_frame.h"
#include "server/contact_log/record_ring.h"
#include "tests/server/contact_log/ring_records.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr char kFirst[] = "/0000000000000001";
constexpr char kSecond[] = "/0000000000000004";
const size_t kSizes[] = {30, 0, 17};

class DamagedSegmentsTest : public ::testing::Test {
 protected:
  // Two segments of three small records each: ids 1 to 6.
  void SetUp() override {
    for (int start = 0; start < 2; ++start) {
      const auto ring = OpenRing(folder_);
      for (const size_t size : kSizes) AppendNext(*ring, size);
    }
    first_ = ReadBytes(folder_ + kFirst);
    second_ = ReadBytes(folder_ + kSecond);
    ASSERT_EQ(second_.size(), 24u + 3 * 20 + 47 + 20);
  }

  static size_t SizeOf(uint64_t id) { return kSizes[(id - 1) % 3]; }

  // The folder as SetUp left it, with other bytes in the second segment.
  void Replace(const std::string& second) {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    WriteBytes(folder_ + kFirst, first_);
    WriteBytes(folder_ + kSecond, second);
  }

  // A new record can be appended, and the file stays as it is.
  void ExpectGoesOn(RecordRing& ring, const std::string& second) {
    const uint64_t id = AppendNext(ring, 9);
    EXPECT_GT(id, 6u);
    ExpectRecord(ring, id, 9);
    EXPECT_EQ(ReadBytes(folder_ + kSecond), second);
    EXPECT_EQ(ring.bytes(), FolderBytes(folder_));
  }

  ScratchDir scratch_;
  const std::string folder_ = scratch_ / "ring";
  std::string first_;
  std::string second_;
};

TEST_F(DamagedSegmentsTest, AreReadUpToWhereTheyWereCut) {
  const std::vector<size_t> ends = {24, 24 + 50, 24 + 70, 24 + 107};
  for (size_t length = 0; length <= second_.size(); ++length) {
    SCOPED_TRACE(length);
    const std::string cut = second_.substr(0, length);
    Replace(cut);
    uint64_t appended = 0;
    {
      const auto ring = OpenRing(folder_);
      for (uint64_t id = 1; id <= 6; ++id) {
        if (id <= 3 || length >= ends[id - 3]) {
          ExpectRecord(*ring, id, SizeOf(id));
        } else {
          ExpectNoRecord(*ring, id);
        }
      }
      const bool is_whole = length == second_.size() ||
                            std::ranges::find(ends, length) != ends.end();
      EXPECT_THAT(ring->damage(), SizeIs(is_whole ? 0 : 1));
      if (!is_whole) {
        EXPECT_THAT(ring->damage()[0], HasSubstr(folder_ + kSecond));
        EXPECT_THAT(ring->damage()[0], HasSubstr("at byte "));
      }
      ExpectGoesOn(*ring, cut);
      appended = ring->next_id() - 1;
      EXPECT_EQ(appended, length == second_.size() ? 7 : 4 + kSegmentIds);
    }
    const auto ring = OpenRing(folder_);
    ExpectRecord(*ring, appended, 9);
    EXPECT_EQ(ring->next_id(), appended + 1);
  }
}

TEST_F(DamagedSegmentsTest, NeverGiveAWrongRecord) {
  size_t errors = 0;
  for (size_t bit = 0; bit < 8 * second_.size(); ++bit) {
    SCOPED_TRACE(bit);
    std::string flipped = second_;
    flipped[bit / 8] ^= static_cast<char>(1 << (bit % 8));
    Replace(flipped);
    const auto ring = OpenRing(folder_);
    EXPECT_THAT(ring->damage(), SizeIs(1));
    for (uint64_t id = 1; id <= 3; ++id) ExpectRecord(*ring, id, SizeOf(id));
    std::map<uint64_t, absl::Status> used;
    const absl::Status all = ring->ForEach(
        [&](uint64_t id, absl::string_view record) {
          EXPECT_TRUE(record == RecordBytes(id, SizeOf(id))) << id;
          used[id] = {};
        },
        [&](uint64_t id, const absl::Status& error) { used[id] = error; });
    EXPECT_TRUE(all.ok()) << all;
    EXPECT_EQ(used.size(), ring->Ids().size());
    EXPECT_LE(ring->Ids().back(), 6u);
    for (uint64_t id = 4; id <= 6; ++id) {
      const auto record = ring->Read(id);
      if (record.ok()) {
        EXPECT_TRUE(*record == RecordBytes(id, SizeOf(id))) << id;
        continue;
      }
      ++errors;
      if (used.contains(id)) {
        EXPECT_EQ(ReasonOf(record.status()), "DATA_LOST");
        EXPECT_EQ(used[id], record.status());
      } else {
        EXPECT_TRUE(absl::IsNotFound(record.status())) << record.status();
      }
    }
    ExpectGoesOn(*ring, flipped);
  }
  EXPECT_GT(errors, second_.size());
}

// Damage of one record leaves those behind it.
TEST_F(DamagedSegmentsTest, NameFileAndOffset) {
  second_[24 + 20 + 3] ^= 1;
  Replace(second_);
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->damage(), ElementsAre(folder_ + kSecond +
                                          ": at byte 24: record 4 is damaged"));
  const absl::Status status = ring->Read(4).status();
  EXPECT_EQ(ReasonOf(status), "DATA_LOST");
  EXPECT_EQ(status.message(), ring->damage()[0]);
  EXPECT_THAT(ring->Ids(), ElementsAre(1, 2, 3, 4, 5, 6));
  ExpectRecord(*ring, 5, SizeOf(5));
  ExpectRecord(*ring, 6, SizeOf(6));
  EXPECT_EQ(ring->next_id(), 7u);
}

TEST_F(DamagedSegmentsTest, AreNoticedWhenTheyAreRead) {
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->damage(), IsEmpty());
  std::string damaged = second_;
  damaged[24 + 20] ^= 1;
  WriteBytes(folder_ + kSecond, damaged);
  EXPECT_EQ(ReasonOf(ring->Read(4).status()), "DATA_LOST");
  ExpectRecord(*ring, 5, SizeOf(5));
  WriteBytes(folder_ + kSecond, second_.substr(0, 50));
  for (const uint64_t id : {4, 5, 6}) {
    const absl::Status status = ring->Read(id).status();
    EXPECT_EQ(ReasonOf(status), "DATA_LOST");
    EXPECT_THAT(std::string(status.message()), HasSubstr(folder_ + kSecond));
    EXPECT_THAT(std::string(status.message()), HasSubstr("at byte "));
  }
  // A record of the same size and another id in its place.
  std::string moved = second_;
  moved.replace(24, 50, EncodeFrame(5, std::string(30, 'x')));
  WriteBytes(folder_ + kSecond, moved);
  EXPECT_EQ(ReasonOf(ring->Read(4).status()), "DATA_LOST");
  fs::remove(folder_ + kSecond);
  EXPECT_EQ(ReasonOf(ring->Read(4).status()), "DATA_LOST");
}

// A frame's header with a checksum that is right.
std::string SealedFrameHeader(uint32_t length, uint64_t id) {
  std::string fields(16, '\0');
  std::memcpy(fields.data(), &length, 4);
  std::memcpy(fields.data() + 4, &id, 8);
  const uint32_t crc = ExtendCrc32c(0, fields);
  std::string header(4, '\0');
  std::memcpy(header.data(), &crc, 4);
  return header + fields;
}

TEST_F(DamagedSegmentsTest, MaySayAnything) {
  const std::string header = EncodeSegmentHeader(4);
  std::string version_2 = header;
  version_2[8] = 2;
  const uint32_t crc =
      ExtendCrc32c(0, absl::string_view(version_2).substr(0, 20));
  std::memcpy(version_2.data() + 20, &crc, 4);
  const struct {
    std::string bytes;
    const char* fault;
  } cases[] = {
      {"", "at byte 0: ends within its header"},
      {std::string(100, '\0'), "is no segment"},
      {std::string(100, '\xff'), "is no segment"},
      {EncodeSegmentHeader(5), "begins with id 5"},
      {version_2, "format version 2"},
      {header + std::string(5'000, '\0'), "at byte 24: no record begins"},
      {header + SealedFrameHeader(0xfffffffe, 4), "no record begins"},
      {header + SealedFrameHeader(1 << 30, 4), "no record begins"},
      {header + SealedFrameHeader(60 << 20, 4), "ends within the record"},
      {header + EncodeFrame(3, "old"), "no record begins"},
      {header + EncodeFrame(4 + kSegmentIds, "new"), "no record begins"},
      {header + EncodeFrame(UINT64_MAX, "new"), "no record begins"},
      {header + EncodeFrame(5, "a") + EncodeFrame(5, "b"), "no record begins"},
      {header + EncodeEndMark(UINT64_MAX), "no record begins"},
      {header + EncodeEndMark(3), "no record begins"},
      {header + EncodeEndMark(9) + "x", "bytes follow its end"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.fault);
    Replace(c.bytes);
    const auto ring = OpenRing(folder_);
    EXPECT_THAT(ring->damage(), ElementsAre(HasSubstr(c.fault)));
    EXPECT_THAT(ring->damage(), Each(HasSubstr(folder_ + kSecond)));
    for (uint64_t id = 1; id <= 3; ++id) ExpectRecord(*ring, id, SizeOf(id));
    EXPECT_EQ(ring->bytes(), FolderBytes(folder_));
    ExpectGoesOn(*ring, c.bytes);
  }
}

TEST_F(DamagedSegmentsTest, MayBeNoFiles) {
  const std::string path = folder_ + "/0000000000000007";
  const std::function<void()> cases[] = {
      [&] { fs::create_directory(path); },
      [&] { fs::create_symlink(folder_ + kFirst, path); },
      [&] { fs::create_symlink("/no/such/file", path); },
      [&] { ASSERT_EQ(mkfifo(path.c_str(), 0600), 0); },
  };
  for (const auto& make : cases) {
    Replace(second_);
    make();
    const auto ring = OpenRing(folder_);
    EXPECT_THAT(ring->damage(), ElementsAre(HasSubstr(path)));
    EXPECT_THAT(ring->Ids(), SizeIs(6));
    EXPECT_EQ(ring->bytes(),
              static_cast<int64_t>(first_.size() + second_.size()));
    EXPECT_EQ(AppendNext(*ring, 9), 7 + kSegmentIds);
    while (*ring->DropOldest()) {
    }
    EXPECT_TRUE(fs::exists(fs::symlink_status(path)));
  }
}

// It takes no room on the disk, and is larger than the memory.
TEST_F(DamagedSegmentsTest, MayBeHuge) {
  constexpr int64_t kHuge = int64_t{1} << 40;
  fs::resize_file(folder_ + kSecond, kHuge);
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->damage(), ElementsAre(HasSubstr("bytes follow its end")));
  EXPECT_EQ(ring->bytes(), kHuge + static_cast<int64_t>(first_.size()));
  ExpectRecord(*ring, 6, SizeOf(6));
  const uint64_t id = AppendNext(*ring, 9);
  EXPECT_LE(FolderBytes(folder_), kRingBytes);
  EXPECT_THAT(ring->Ids(), ElementsAre(id));
}

// Files that cannot be read are removed in their turn.
TEST_F(DamagedSegmentsTest, TakeNoRoomForEver) {
  Replace(std::string(100'000, 'x'));
  const auto ring = OpenRing(folder_);
  EXPECT_EQ(ring->bytes(), 100'000 + static_cast<int64_t>(first_.size()));
  for (int i = 0; i < 60; ++i) {
    AppendNext(*ring, 40'000);
    ASSERT_LE(FolderBytes(folder_), kRingBytes);
  }
  EXPECT_FALSE(fs::exists(folder_ + kSecond));
}

TEST_F(DamagedSegmentsTest, MayUseUpTheIds) {
  WriteBytes(folder_ + "/1000000000000000", "");
  const auto ring = OpenRing(folder_);
  EXPECT_THAT(ring->Ids(), SizeIs(6));
  const absl::Status status = ring->Append("x").status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("ids are used up"));
  ExpectRecord(*ring, 6, SizeOf(6));
}

}  // namespace
}  // namespace tactus::internal::server
