// File: chunk_pool.h
//
// ChunkPool: memory for what is being recorded, in chunks of one size. It is
// reserved once, and costs what is used of it.
//
//   ChunkPool pool(100);
//   const int chunk = pool.Take();
//   if (chunk != ChunkPool::kNone) Fill(pool.bytes(chunk));
//   pool.Give(chunk);
//
// Thread-safe, without locks: a stack of free chunks (R. K. Treiber, "Systems
// programming: coping with parallelism", 1986), whose head counts its changes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/limits_contact_log.h"

namespace tactus::internal::server {

class ChunkPool {
 public:
  static constexpr int kNone = -1;

  // `chunks`: at least 1.
  explicit ChunkPool(size_t chunks);

  ChunkPool(const ChunkPool&) = delete;
  ChunkPool& operator=(const ChunkPool&) = delete;

  // The caller's until Give; kNone if none is free.
  int Take();
  void Give(int chunk);
  std::span<uint8_t> bytes(int chunk) {
    return {bytes_.get() + chunk * limits::kRecordingChunkBytes,
            limits::kRecordingChunkBytes};
  }
  // Free chunks; right while nobody takes or gives.
  size_t free() const;

 private:
  // The first free chunk in the lower half; the number of changes above it.
  std::atomic<uint64_t> head_;
  // The free chunk after each free chunk.
  const std::unique_ptr<std::atomic<int32_t>[]> next_;
  const std::unique_ptr<uint8_t[]> bytes_;
};

}  // namespace tactus::internal::server
