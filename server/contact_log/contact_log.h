// File: contact_log.h
//
// ContactLog: the last contacts of all streams, on disk. The recorders of the
// streams hand over what they finished. The log has a thread of low priority,
// which writes it.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto log, ContactLog::Open(options));
//   const auto recorder = log->Record(stream);
//   session.SetTap(recorder.get());
//   recorder->EndStream(now_ms);
//   TACTUS_ASSIGN_OR_RETURN(const auto page, log->List(request));
//
// A contact appears in lists within some 0.2 s of its end. What was recorded
// and is not on disk when the process dies is lost, and a dying machine may
// lose the newest segment of the ring (record_ring.h).
//
// Thread-safe. Recorders must end before it does.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "server/contact_log/chunk_pool.h"
#include "server/contact_log/contact_index.h"
#include "server/contact_log/contact_name.h"
#include "server/contact_log/contact_recorder.h"
#include "server/contact_log/record_ring.h"
#include "server/session/model_source.h"
#include "tactus/v1/contact_log.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class ContactLog final : private RecordingSink {
 public:
  struct Options {
    // Made if its parent exists.
    std::string folder = {};
    // On disk; at least limits::kMinContactLogBytes.
    int64_t max_bytes = 0;
    // Chunks of memory for recordings.
    size_t chunks = limits::kRecordingChunks;
    // Whose shadows answer contacts once more; null for none. Must outlive the
    // log.
    const ModelSource* models = nullptr;
    // Free bytes of the disk, or -1; the file system's if empty.
    std::function<int64_t()> free_bytes = {};
  };
  // What the log has.
  struct Totals {
    size_t contacts = 0;
    // Contacts or stretches of several that were not kept since the start.
    uint64_t left_out = 0;
    int64_t bytes = 0;
    int64_t max_bytes = 0;
    // Contacts that a shadow answered as the served model did, and otherwise.
    uint64_t shadow_agrees = 0;
    uint64_t shadow_differs = 0;
    // Recordings that no shadow answered, because too many waited.
    uint64_t shadow_skipped = 0;
  };

  // Reads what the folder has. INVALID_CONFIG, IO.
  static absl::StatusOr<std::unique_ptr<ContactLog>> Open(
      const Options& options, FileSystem& files = PosixFileSystem());
  // Writes what waits.
  ~ContactLog();

  // For a stream that begins.
  std::unique_ptr<ContactRecorder> Record(v1::RecordedStream stream);
  // Returns when all that recorders have handed over is in lists.
  void Flush();

  // The errors of ContactIndex::Search.
  absl::StatusOr<v1::ListContactsResponse> List(
      const v1::ListContactsRequest& request) const;
  // The contacts of one record with their frames; those of `contacts` have
  // names and labels. CONTACT_NOT_FOUND, DATA_LOST.
  absl::StatusOr<v1::StoredContacts> Read(const ContactName& name) const;
  // Remembers labels of contacts that are in the log. STORAGE_FULL, IO.
  absl::Status AddLabels(const v1::StoredLabels& labels);

  Totals totals() const;
  // What was damaged when it was opened, each a line.
  const std::vector<std::string>& damage() const { return damage_; }

 private:
  ContactLog(std::unique_ptr<RecordRing> ring, const Options& options);
  absl::Status ReadAll();
  void AddToIndex(uint64_t id, const v1::LogRecord& record);

  bool TryTake(FinishedRecording& recording) override;
  void Take(FinishedRecording& recording) override;
  void OnLeftOut() override { ++left_out_; }

  // On the writer's thread.
  void Run();
  // `waiting`: how many recordings wait behind it.
  void Write(FinishedRecording& recording, size_t waiting);
  void AskShadow(v1::StoredContacts& stored, size_t waiting);
  void GiveRoomBack();
  // With `ring_mutex_`: appends a record and forgets what that removed.
  absl::Status Append(const v1::LogRecord& record);

  const ModelSource* const models_;
  const std::function<int64_t()> free_bytes_;
  ChunkPool pool_;
  std::vector<std::string> damage_;
  std::atomic<uint64_t> left_out_ = 0;
  std::atomic<uint64_t> shadow_agrees_ = 0;
  std::atomic<uint64_t> shadow_differs_ = 0;
  std::atomic<uint64_t> shadow_skipped_ = 0;

  // Held while the ring is written.
  std::mutex ring_mutex_;
  const std::unique_ptr<RecordRing> ring_;

  mutable std::mutex index_mutex_;
  ContactIndex index_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  // Has room for all, so that adding allocates nothing.
  std::vector<FinishedRecording> waiting_;
  // Recordings that were handed over, and that were dealt with.
  uint64_t taken_ = 0;
  uint64_t done_ = 0;
  std::thread writer_;
};

}  // namespace tactus::internal::server
