// Rings on disks that are full or fail, and what crashes leave of them.
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <map>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/contact_log/record_ring.h"
#include "tests/server/contact_log/ring_records.h"
#include "tests/support/crash_file_system.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal::server {
namespace {

using internal::testing::CrashFileSystem;
using ::testing::IsEmpty;
using Loss = CrashFileSystem::Loss;

// Two of them fill a segment.
constexpr size_t kSize = 30'000;
// More than the ring holds.
constexpr int kRecords = 36;

class RingCrashTest : public ::testing::Test {
 protected:
  // Only one test mounts it.
  void TearDown() override { umount(disk_.c_str()); }

  // Appends kRecords and returns their ids. Stops at the first error; or heals
  // `healed` and goes on.
  static std::vector<uint64_t> AppendAll(RecordRing& ring,
                                         CrashFileSystem* healed = nullptr) {
    std::vector<uint64_t> ids;
    for (int i = 0; i < kRecords; ++i) {
      const auto id = ring.Append(RecordBytes(ring.next_id(), kSize));
      if (id.ok()) {
        ids.push_back(*id);
      } else if (healed != nullptr) {
        healed->Heal();
      } else {
        break;
      }
    }
    return ids;
  }

  // Which operation fails after number `point` did: each of the first ones, and
  // then some of each kind, as a segment takes 6 or 7.
  static int PointAfter(int point) { return point + (point < 20 ? 1 : 5); }

  // Those of `ids` that are in older segments than the one at `path`; none if
  // that is only the folder.
  static std::vector<uint64_t> OlderThan(const std::string& path,
                                         std::vector<uint64_t> ids) {
    const std::string name = path.substr(path.rfind('/') + 1);
    const uint64_t first = std::strtoull(name.c_str(), nullptr, 10);
    std::erase_if(ids, [&](uint64_t id) { return id >= first; });
    return ids;
  }

  // Nothing of `ids` from `first` on is missing, and new ids are greater.
  void ExpectAllFrom(uint64_t first, const std::vector<uint64_t>& ids,
                     RecordRing& ring) {
    // A record that could not be returned may be there.
    const std::vector<uint64_t> all = ring.Ids();
    for (const uint64_t id : all) ExpectRecord(ring, id, kSize);
    for (const uint64_t id : ids) {
      EXPECT_TRUE(id < first || std::ranges::binary_search(all, id)) << id;
    }
    EXPECT_EQ(ring.bytes(), FolderBytes(folder_));
    EXPECT_LE(ring.bytes(), kRingBytes);
    for (int i = 0; i < 3; ++i) {
      const uint64_t id = AppendNext(ring, kSize);
      EXPECT_GT(id, ids.empty() ? 0 : ids.back());
      ExpectRecord(ring, id, kSize);
      EXPECT_LE(FolderBytes(folder_), kRingBytes);
    }
  }

  ScratchDir scratch_;
  const std::string folder_ = scratch_ / "ring";
  const std::string disk_ = scratch_ / "disk";
};

// The machine stops at each operation. What is older than the newest segment is
// there, and no id is given twice.
TEST_F(RingCrashTest, LosesAtMostTheNewestSegment) {
  int points = 0;
  for (const Loss loss : CrashFileSystem::kLosses) {
    bool more = true;
    for (int stop = 1; more && !HasFailure();
         stop = PointAfter(stop), ++points) {
      SCOPED_TRACE(stop);
      std::filesystem::remove_all(folder_);
      CrashFileSystem files;
      files.StopAt(stop);
      std::vector<uint64_t> ids;
      uint64_t oldest = 1;
      std::string newest;
      if (auto ring = RecordRing::Open(folder_, kRingBytes, files); ring.ok()) {
        ids = AppendAll(**ring);
        oldest = (*ring)->first_id();
        newest = NewestSegment(folder_);
      }
      more = files.failed();
      files.Lose(loss);
      files.Heal();
      if (std::filesystem::exists(folder_)) {
        EXPECT_LE(FolderBytes(folder_), kRingBytes);
      }
      const auto ring = OpenRing(folder_, kRingBytes, files);
      if (!ring->Ids().empty()) {
        EXPECT_LE(ring->first_id(), oldest);
      }
      EXPECT_GT(ring->next_id(), ids.empty() ? 0 : ids.back());
      const bool lost = loss != Loss::kNothing && more;
      ExpectAllFrom(oldest, lost ? OlderThan(newest, ids) : ids, *ring);
    }
  }
  RecordProperty("points", points);
}

// Each operation fails, as when another program has filled the disk for a
// moment: it alone, or also what clears up behind it.
TEST_F(RingCrashTest, GoesOnAfterEachFailure) {
  for (const bool alone : {true, false}) {
    bool more = true;
    for (int stop = 1; more && !HasFailure(); stop = PointAfter(stop)) {
      SCOPED_TRACE(stop);
      std::filesystem::remove_all(folder_);
      CrashFileSystem files;
      if (alone) {
        files.FailAt(stop, StorageFull("disk", "no room"));
      } else {
        files.StopAt(stop);
      }
      auto opened = RecordRing::Open(folder_, kRingBytes, files);
      if (!opened.ok()) continue;
      const std::vector<uint64_t> ids = AppendAll(**opened, &files);
      EXPECT_GE(ids.size(), kRecords - 1u);
      more = ids.size() < kRecords;
      files.Heal();
      const uint64_t oldest = (*opened)->first_id();
      ExpectAllFrom(oldest, ids, **opened);
      const uint64_t next = (*opened)->next_id();
      opened->reset();
      const auto ring = OpenRing(folder_, kRingBytes, files);
      if (alone) {
        EXPECT_THAT(ring->damage(), IsEmpty());
      }
      EXPECT_EQ(ring->next_id(), next);
      ExpectAllFrom(std::max(oldest, ring->first_id()), ids, *ring);
    }
  }
}

// Appends for ever, and reports each id.
[[noreturn]] void AppendAndReport(const std::string& folder, int pipe) {
  auto ring = RecordRing::Open(folder, 64 * kRingBytes);
  if (!ring.ok()) _exit(1);
  while (true) {
    const uint64_t next = (*ring)->next_id();
    const auto id = (*ring)->Append(RecordBytes(next, 100 * (next % 90)));
    if (!id.ok() || write(pipe, &*id, sizeof *id) != sizeof *id) _exit(1);
  }
}

// Kills a writer when it has reported `count` ids; returns all that it did.
std::vector<uint64_t> KillAfter(size_t count, const std::string& folder) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    AppendAndReport(folder, ends[1]);
  }
  close(ends[1]);
  std::vector<uint64_t> ids;
  uint64_t id = 0;
  while (read(ends[0], &id, sizeof id) == sizeof id) {
    ids.push_back(id);
    if (ids.size() == count) kill(child, SIGKILL);
  }
  close(ends[0]);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status)) << "it ended by itself: " << status;
  return ids;
}

TEST_F(RingCrashTest, AKilledProcessLosesNothing) {
  constexpr uint64_t kSeed = 3;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  std::vector<uint64_t> ids;
  for (int kills = 0; kills < 20; ++kills) {
    for (const uint64_t id : KillAfter(1 + random.Index(200), folder_)) {
      ASSERT_GT(id, ids.empty() ? 0 : ids.back());
      ids.push_back(id);
    }
    const auto ring = OpenRing(folder_, 64 * kRingBytes);
    for (const uint64_t id : ids) ExpectRecord(*ring, id, 100 * (id % 90));
    ASSERT_GT(ring->next_id(), ids.back());
  }
  EXPECT_GT(ids.size(), 20u);
}

// A file system of 512 KiB that only this process sees. False if it may not.
bool MountTinyDisk(const std::string& folder) {
  return unshare(CLONE_NEWNS) == 0 &&
         mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=512k") == 0;
}

TEST_F(RingCrashTest, AFullDiskLosesNothing) {
  std::filesystem::create_directory(disk_);
  if (!MountTinyDisk(disk_)) {
    GTEST_SKIP() << "this process may not mount a file system";
  }
  auto ring = OpenRing(disk_ + "/ring", kRingBytes);
  std::map<uint64_t, size_t> sizes;
  Random random(5);
  int full = 0;
  for (int i = 0; i < 300; ++i) {
    const uint64_t next = ring->next_id();
    const size_t size = random.Index(60'000);
    const auto id = ring->Append(RecordBytes(next, size));
    if (id.ok()) {
      sizes[*id] = size;
    } else {
      ++full;
      EXPECT_EQ(ReasonOf(id.status()), "STORAGE_FULL") << id.status();
      ExpectNoRecord(*ring, next);
      if (full % 10 == 0) {
        while (*ring->DropOldest()) {
        }
        // With less than a segment there, this frees the newest.
        EXPECT_THAT(ring->Ids(), IsEmpty());
      } else {
        EXPECT_TRUE(*ring->DropOldest());
      }
    }
    sizes.erase(sizes.begin(), sizes.lower_bound(ring->first_id()));
    ASSERT_EQ(ring->Ids().size(), sizes.size());
    EXPECT_EQ(ring->bytes(), FolderBytes(disk_ + "/ring"));
    if (i % 50 == 49) {
      ring = nullptr;
      ring = OpenRing(disk_ + "/ring", kRingBytes);
    }
    for (const auto& [known, bytes] : sizes) {
      ExpectRecord(*ring, known, bytes);
    }
  }
  EXPECT_GT(full, 20);
}

}  // namespace
}  // namespace tactus::internal::server
