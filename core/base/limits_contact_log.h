// File: limits_contact_log.h
//
// Limits of the contact log. Thread-safe: constants.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// The least that a contact log may have on disk: its largest record is a
// sixteenth of it.
inline constexpr int64_t kMinContactLogBytes = 16L * 1024 * 1024;
// Contacts that a log has at most, because what is listed of them is in memory.
inline constexpr size_t kMaxLoggedContacts = 50'000;
// Free bytes of its disk below which a log gives room back.
inline constexpr int64_t kContactLogSpareBytes = 64L * 1024 * 1024;
// Memory of what is recorded and not on disk yet, for all streams together, in
// chunks of this size. A message of a robot fits into one.
inline constexpr size_t kRecordingChunkBytes = 72UL * 1024;
inline constexpr size_t kRecordingChunks = 3'600;
// Chunks of one recording, and those of them that frames may fill.
inline constexpr int kMaxRecordingChunks = 32;
inline constexpr int kMaxFrameChunks = 28;
// Chunks that are kept of the frames before a contact.
inline constexpr int kBeforeContactChunks = 4;
// Recordings that wait for the disk.
inline constexpr size_t kMaxWaitingRecordings = 1'024;
// Recordings that may wait while a shadow answers another one.
inline constexpr size_t kMaxWaitingForShadow = 16;
// Contacts of a page, and names of one request.
inline constexpr int kDefaultListedContacts = 50;
inline constexpr int kMaxListedContacts = 200;
// Labels of one request.
inline constexpr int kMaxContactLabels = 1'000;
// Frames of one replay.
inline constexpr uint32_t kDefaultReplayFrames = 200;
inline constexpr uint32_t kMaxReplayFrames = 1'000;
// Bytes of its frames, for which fewer are shown, and those with events too: a
// client of gRPC takes messages of 4 MiB.
inline constexpr size_t kReplayedBytes = 2UL * 1024 * 1024;
inline constexpr size_t kMaxReplayedBytes = 3UL * 1024 * 1024;

}  // namespace tactus::internal::limits
