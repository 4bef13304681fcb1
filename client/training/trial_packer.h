// File: trial_packer.h
//
// TrialPacker: cuts the pack of all trials into chunks, on a thread that works
// ahead of its reader.
//
//   TrialPacker packer(next_trial, {.chunk_bytes = 1 << 20});
//   while (true) {
//     TACTUS_ASSIGN_OR_RETURN(const PackChunk chunk, packer.Next());
//     if (chunk.data.empty()) break;
//     send(chunk.offset, chunk.data);
//   }
//
// `next_trial` is called on that thread and must outlive the packer. Memory:
// Options::ahead_bytes, one chunk and one trial. Belongs to one thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal::client {

// Returns the next trial; nothing after the last one.
using NextTrial = std::function<absl::StatusOr<std::optional<Trial>>()>;

struct PackChunk {
  int64_t offset = 0;
  std::string data;
  // Trials that were packed when the chunk was full.
  uint64_t trials = 0;
};

class TrialPacker {
 public:
  struct Options {
    size_t chunk_bytes = 1024 * 1024;
    // Chunks are made ahead as long as they have fewer bytes together.
    size_t ahead_bytes = 0;
  };

  TrialPacker(const NextTrial& next_trial, Options options);
  // Waits for the present call of `next_trial`.
  ~TrialPacker();

  // The next chunk; an empty one at the end. After an error of `next_trial`,
  // that error.
  absl::StatusOr<PackChunk> Next();

  // True if Next has returned the end.
  bool ended() const { return ended_; }
  // Size and checksum of all chunks that Next has returned.
  int64_t size() const { return size_; }
  uint32_t crc32c() const { return crc32c_; }
  uint64_t trials() const { return trials_; }

 private:
  // On the thread.
  void Run();
  absl::StatusOr<PackChunk> Make();
  // Returns false if nobody wants chunks any more.
  bool Hand(absl::StatusOr<PackChunk> chunk);

  const NextTrial& next_trial_;
  const Options options_;

  // Used by the thread alone: bytes of trials, how many of them are in chunks,
  // their offset in the pack, and the number of trials.
  std::string pending_;
  size_t taken_ = 0;
  int64_t offset_ = 0;
  uint64_t packed_ = 0;
  bool last_ = false;

  // Used by the reader alone.
  bool ended_ = false;
  int64_t size_ = 0;
  uint32_t crc32c_ = 0;
  uint64_t trials_ = 0;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<absl::StatusOr<PackChunk>> ready_;
  size_t ready_bytes_ = 0;
  bool stopping_ = false;
  // Begins when all of the above exists.
  std::thread thread_;
};

}  // namespace tactus::internal::client
