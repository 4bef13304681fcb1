// File: limits_catalog.h
//
// Limits of a catalogue in PostgreSQL, and of the servers that share it.
#pragma once

#include <cstdint>

namespace tactus::internal::limits {

// Milliseconds for a connection to come about, and for a statement.
inline constexpr int kCatalogConnectMs = 3'000;
inline constexpr int kCatalogAnswerMs = 4'000;
// Milliseconds for a change with all its tries.
inline constexpr int kCatalogChangeMs = 10'000;
// Connections of one process.
inline constexpr int kCatalogConnections = 8;
// Milliseconds between two signs of life of a process, and after which others
// take it for dead.
inline constexpr int kReplicaBeatMs = 1'000;
inline constexpr int kReplicaDeadMs = 10'000;
// Milliseconds after which the record of a dead process is removed.
inline constexpr int kForgetReplicaMs = 3'600'000;
// Milliseconds for a lock that somebody else has.
inline constexpr int kLockPatienceMs = 60'000;
// Milliseconds for which a blob that was removed from a shared folder is kept.
inline constexpr int64_t kRemovedBlobMs = 24L * 3'600 * 1'000;

}  // namespace tactus::internal::limits
