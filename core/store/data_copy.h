// File: data_copy.h
//
// Copies all data of a server from one place to another: from a data directory
// to a catalogue and a folder that several servers share, or back.
//
//   TACTUS_ASSIGN_OR_RETURN(auto from, OpenDirectoryToCopy(files, "/data"));
//   TACTUS_ASSIGN_OR_RETURN(
//       const CopyReport report,
//       CopyData(files, from->place(),
//                {.catalog = shared, .folder = "/mnt/tactus", .shared = true},
//                progress));
//
// Copied: all records but those below; the blobs that records name; the bytes
// of uploads that are not finished; the files of jobs that have not ended.
//
// Not copied: what belongs to the place or to its processes, which are the
// directory's identity, replicas and their numbers, leases, signs of life, the
// lock, the marker, the reserve; and what nothing names: other blobs, drafts,
// lost+found. The contact log stays with its server.
//
// A copy may end anywhere; the next one with the same source goes on. Until it
// is finished, servers refuse the target. The source is only read.
//
// Thread-safe: free functions without state. What they are given must outlive
// the call.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/work.h"
#include "core/store/catalog.h"
#include "core/store/file_system.h"

namespace tactus::internal {

// Where a server's data is.
struct CopyPlace {
  Catalog* catalog = nullptr;
  // With blobs/, uploads/ and jobs/.
  std::string folder = {};
  // Servers share it; else the caller holds the folder's lock.
  bool shared = false;
  // The servers that are at work there, for people; none if empty.
  std::function<absl::StatusOr<std::vector<std::string>>()> servers = {};
};

struct CopyReport {
  // An earlier run had begun it.
  bool resumed = false;
  int64_t records = 0;
  // SHA-256 of all records that are copied, the same on both sides.
  std::string records_sha256;
  int64_t blobs = 0;
  int64_t blob_bytes = 0;
  int64_t uploads = 0;
  int64_t jobs = 0;
  // Blobs of the source that no record names. They were not copied.
  int64_t unnamed_blobs = 0;
};

// IO if servers are at work on a side, if the target holds something else, or
// if the source changed meanwhile; DATA_LOST names what the source lacks or has
// damaged; ABORTED if another run goes on; and those of storage.
absl::StatusOr<CopyReport> CopyData(FileSystem& files, const CopyPlace& from,
                                    const CopyPlace& to,
                                    const Progress& progress = {});

}  // namespace tactus::internal
