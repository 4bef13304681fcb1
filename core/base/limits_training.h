// File: limits_training.h
//
// Limits of what the training service parses, keeps and holds in memory, beside
// those in limits.h. Thread-safe: constants.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// One request, where server/rpc/request_limits.cc has no other limit.
inline constexpr size_t kMaxControlRequestBytes = 16 * 1024;
// Memory of all trials that are parsed at one time, for all callers together. A
// larger one is parsed alone.
inline constexpr int64_t kMaxParsingBytes = 256L * 1024 * 1024;
// Memory for what is known of the trials of all uploads that are not finished.
inline constexpr int64_t kMaxKnownTrialBytes = 64L * 1024 * 1024;
// Trials of one upload.
inline constexpr size_t kMaxTrialsPerUpload = 200'000;
// Trials of one dataset version: what reads a version holds all their names.
inline constexpr size_t kMaxTrialsPerVersion = 1'000'000;
// Memory of the lists of trials that are read from the catalogue at one time,
// for all callers together, and what one trial of a list is taken to need. A
// longer list is read alone.
inline constexpr int64_t kMaxListingBytes = 512L * 1024 * 1024;
inline constexpr int64_t kListedTrialBytes = 640;
// Memory that all downloads together may hold: 36 bytes for each of their
// trials.
inline constexpr int64_t kMaxDownloadBytes = 256L * 1024 * 1024;
// Uploads of one client that are not finished; each has a record and a file.
inline constexpr int64_t kMaxOpenUploads = 1'000;
// Bytes of the model versions that one client made: each is held in memory.
inline constexpr int64_t kMaxClientModelBytes = 512L * 1024 * 1024;
// How long a job is kept that has ended, and how many of one client.
inline constexpr int64_t kKeptJobMs = 90L * 24 * 3'600 * 1'000;
inline constexpr int kMaxKeptJobs = 1'000;

// Shards of a batch of LSTM training.
inline constexpr int kMaxGradientShards = 64;
// Ranks of a training.
inline constexpr int kMaxJobRanks = 1024;

}  // namespace tactus::internal::limits
