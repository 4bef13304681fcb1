// File: contact_facts.h
//
// What a list says of the contacts of a recording, and a small picture of each.
//
//   TACTUS_ASSIGN_OR_RETURN(const v1::StoredContacts stored,
//                           StoreRecording(recording, pool));
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <map>

#include "absl/status/statusor.h"
#include "server/contact_log/chunk_pool.h"
#include "server/contact_log/finished_recording.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

// What the answers of a recording say of its contacts when they ended, by their
// ids, which rise with their onsets. `begin_time_ms` is by the robot's clock;
// frames have no part in it.
std::map<uint64_t, v1::LoggedContact> ContactsOf(
    const v1::Recording& recording, const v1::RecordedStream& stream);

// The recording as it is stored.
absl::StatusOr<v1::StoredContacts> StoreRecording(
    const FinishedRecording& recording, ChunkPool& pool);

// The recording in stored contacts. DATA_LOST.
absl::StatusOr<v1::Recording> RecordingOf(const v1::StoredContacts& stored);

}  // namespace tactus::internal::server
