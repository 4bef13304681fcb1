// File: ring_records.h
//
// Records whose bytes follow from their id, and checks of rings that hold them.
//
//   auto ring = OpenRing(folder);
//   const uint64_t id = AppendNext(*ring, 100);
//   ExpectRecord(*ring, id, 100);
//
// Sizes are in bytes. Test-only.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "gtest/gtest.h"
#include "server/contact_log/record_ring.h"

namespace tactus::internal::server {

// The size of most rings here.
inline constexpr int64_t kRingBytes = RecordRing::kMinBytes;

// Other ids and other sizes give other bytes.
inline std::string RecordBytes(uint64_t id, size_t size) {
  // Prime, so that no part of a record is at the same place of a block.
  std::array<uint64_t, 127> pattern;
  Random::ForStream(id, size).Fill(pattern);
  std::string bytes;
  bytes.reserve(size);
  while (bytes.size() < size) {
    bytes.append(reinterpret_cast<const char*>(pattern.data()),
                 std::min(sizeof pattern, size - bytes.size()));
  }
  return bytes;
}

inline std::unique_ptr<RecordRing> OpenRing(
    const std::string& folder, int64_t max_bytes = kRingBytes,
    FileSystem& files = PosixFileSystem()) {
  auto ring = RecordRing::Open(folder, max_bytes, files);
  EXPECT_TRUE(ring.ok()) << ring.status();
  return ring.ok() ? *std::move(ring) : nullptr;
}

// Appends the record of the next id; returns the id, 0 after a failure.
inline uint64_t AppendNext(RecordRing& ring, size_t size) {
  const uint64_t next = ring.next_id();
  const auto id = ring.Append(RecordBytes(next, size));
  EXPECT_TRUE(id.ok()) << id.status();
  EXPECT_EQ(id.value_or(next), next);
  return id.value_or(0);
}

inline void ExpectRecord(const RecordRing& ring, uint64_t id, size_t size) {
  const auto record = ring.Read(id);
  ASSERT_TRUE(record.ok()) << record.status();
  EXPECT_TRUE(*record == RecordBytes(id, size)) << "record " << id;
}

inline void ExpectNoRecord(const RecordRing& ring, uint64_t id) {
  EXPECT_TRUE(absl::IsNotFound(ring.Read(id).status()))
      << "record " << id << ": " << ring.Read(id).status();
}

// All files of a folder.
inline int64_t FolderBytes(const std::string& folder) {
  int64_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (file.is_regular_file()) {
      bytes += static_cast<int64_t>(file.file_size());
    }
  }
  return bytes;
}

// The segment whose name is the greatest.
inline std::string NewestSegment(const std::string& folder) {
  std::string newest;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename();
    if (name.size() == 16) newest = std::max(newest, name);
  }
  return folder + "/" + newest;
}

}  // namespace tactus::internal::server
