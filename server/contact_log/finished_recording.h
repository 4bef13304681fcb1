// File: finished_recording.h
//
// FinishedRecording: a stretch of a stream with its contacts, as its stream's
// thread hands it to the thread that writes.
//
//   const std::string bytes = recording.Join(pool);  // a v1::Recording
//   recording.GiveBack(pool);
//
// Plain data: the chunks belong to whoever has it. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "core/base/limits_contact_log.h"
#include "server/contact_log/chunk_pool.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

struct FinishedRecording {
  std::shared_ptr<const v1::RecordedStream> stream;
  std::array<int, limits::kMaxRecordingChunks> chunks = {};
  // Bytes used of each.
  std::array<uint32_t, limits::kMaxRecordingChunks> sizes = {};
  int count = 0;
  // LoggedContact.cut and .exact.
  bool cut = false;
  bool exact = false;
  // When its last message came, in milliseconds since 1970 (UTC).
  int64_t end_time_ms = 0;

  // The serialised v1::Recording.
  std::string Join(ChunkPool& pool) const {
    std::string bytes;
    size_t size = 0;
    for (int i = 0; i < count; ++i) size += sizes[i];
    bytes.reserve(size);
    for (int i = 0; i < count; ++i) {
      const auto chunk = pool.bytes(chunks[i]).first(sizes[i]);
      bytes.append(chunk.begin(), chunk.end());
    }
    return bytes;
  }
  void GiveBack(ChunkPool& pool) {
    for (int i = 0; i < count; ++i) pool.Give(chunks[i]);
    count = 0;
  }
};

}  // namespace tactus::internal::server
