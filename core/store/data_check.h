// File: data_check.h
//
// Checks a data directory that no server uses: catalogue, records, blobs, and
// what was left behind. Or the same of a catalogue and a folder that servers
// share; while they are at work, only the records and what these name.
//
//   for (const CheckResult& result :
//        CheckData(PosixFileSystem(), "/data", {.now_ms = now_ms})) {
//     Print(result);
//   }
//
// Changes nothing without `repair` or `accept_catalog`. A repair moves what no
// record names to the folder lost+found: blobs and drafts, files of uploads,
// folders of jobs; and uploads that nobody wrote to for
// limits::kAbandonedUploadMs. It deletes no file. It moves nothing if a record
// cannot be read, because that record may name it.
//
// Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/store/catalog.h"
#include "core/store/file_system.h"

namespace tactus::internal {

struct CheckResult {
  enum class Severity { kOk, kWarning, kError };

  // What was checked, e.g. "blobs".
  std::string check;
  Severity severity = Severity::kOk;
  // What was found.
  std::string text;
  // What to do; empty if there is nothing.
  std::string advice = {};
};

struct DataCheckOptions {
  // Milliseconds since 1970 (UTC).
  int64_t now_ms = 0;
  bool repair = false;
  // Takes the catalogue that is there as that of the directory: a new one if
  // there is none or it is damaged. A damaged one is moved to lost+found.
  bool accept_catalog = false;
  // Free bytes of the file system of a folder; the system's answer if empty.
  std::function<int64_t(const std::string& folder)> free_bytes = {};
};

std::vector<CheckResult> CheckData(FileSystem& files, const std::string& folder,
                                   const DataCheckOptions& options);

// A catalogue that servers share.
struct SharedCatalog {
  Catalog* catalog = nullptr;
  // Its address without a password.
  std::string address = {};
  // The servers that are at work on it, for people.
  std::vector<std::string> servers = {};
};

// `folder` is the one that the servers share. Repairs nothing while they are at
// work, and accepts no catalogue.
std::vector<CheckResult> CheckSharedData(FileSystem& files,
                                         const std::string& folder,
                                         const SharedCatalog& shared,
                                         const DataCheckOptions& options);

}  // namespace tactus::internal
