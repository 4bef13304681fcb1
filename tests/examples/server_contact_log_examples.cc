// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <string>

#include "core/base/status_macros.h"
#include "core/stream/contact_session.h"
#include "server/contact_log/chunk_pool.h"
#include "server/contact_log/contact_facts.h"
#include "server/contact_log/contact_index.h"
#include "server/contact_log/contact_log.h"
#include "server/contact_log/contact_name.h"
#include "server/contact_log/contact_recorder.h"
#include "server/contact_log/contact_replay.h"
#include "server/contact_log/finished_recording.h"
#include "server/contact_log/logged_trial.h"
#include "server/contact_log/record_frame.h"
#include "server/contact_log/record_ring.h"
#include "server/contact_log/recording_bytes.h"
#include "server/contact_log/segment_scan.h"

namespace tactus::internal::server::examples {

static void Use(uint64_t) {}

static void RecordFrameExample(uint64_t first_id, const std::string& record) {
#include "server/contact_log/record_frame.h.inc"
}

static absl::Status SegmentScanExample() {
#include "server/contact_log/segment_scan.h.inc"
  return absl::OkStatus();
}

static void Fill(std::span<uint8_t>) {}
static void Print(const std::string&) {}

static void ChunkPoolExample() {
#include "server/contact_log/chunk_pool.h.inc"
}

static absl::Status ContactNameExample(const std::string& text) {
#include "server/contact_log/contact_name.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordingBytesExample(const std::string& bytes) {
#include "server/contact_log/recording_bytes.h.inc"
  return absl::OkStatus();
}

static void FinishedRecordingExample(FinishedRecording recording,
                                     ChunkPool& pool) {
#include "server/contact_log/finished_recording.h.inc"
}

static absl::Status ContactFactsExample(const FinishedRecording& recording,
                                        ChunkPool& pool) {
#include "server/contact_log/contact_facts.h.inc"
  return absl::OkStatus();
}

static absl::Status ContactIndexExample(
    ContactIndex& index, const v1::StoredContacts& stored,
    const v1::ListContactsRequest& request) {
#include "server/contact_log/contact_index.h.inc"
  return absl::OkStatus();
}

static void ContactRecorderExample(
    ChunkPool& pool, RecordingSink& sink,
    const std::shared_ptr<const v1::RecordedStream>& stream,
    ContactSession& session, const v1::FrameBatch& batch, int64_t now_ms) {
#include "server/contact_log/contact_recorder.h.inc"
}

static absl::Status ContactReplayExample(const v1::StoredContacts& stored,
                                         const PinnedModel& model) {
#include "server/contact_log/contact_replay.h.inc"
  return absl::OkStatus();
}

static absl::Status LoggedTrialExample(const v1::StoredContacts& stored,
                                       const v1::ContactLabel& label) {
#include "server/contact_log/logged_trial.h.inc"
  return absl::OkStatus();
}

static absl::Status ContactLogExample(const ContactLog::Options& options,
                                      const v1::RecordedStream& stream,
                                      ContactSession& session,
                                      const v1::ListContactsRequest& request,
                                      int64_t now_ms) {
#include "server/contact_log/contact_log.h.inc"
  return absl::OkStatus();
}

static absl::Status RecordRingExample(const std::string& bytes) {
#include "server/contact_log/record_ring.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::server::examples
