// File: exit_status.h
//
// How tactus-trainer ends when it cannot write down why it failed.
//
//   if (end.status == kExitStorageFull) return StorageFull(folder, "...");
//
// Constants without state.
#pragma once

namespace tactus::internal::server {

// It did the job; the outcome is in the job's folder.
inline constexpr int kExitDone = 0;
// Standard error says why.
inline constexpr int kExitFailed = 1;
// It may not have the memory that it needs.
inline constexpr int kExitOutOfMemory = 3;
// The disk has no room for the outcome.
inline constexpr int kExitStorageFull = 4;

}  // namespace tactus::internal::server
