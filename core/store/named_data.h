// File: named_data.h
//
// NamedData: what the records of a catalogue name outside of it: blobs, files
// of uploads, folders of jobs.
//
//   NamedData named;
//   TACTUS_RETURN_IF_ERROR(named.Take(Table::kTrials, entry));
//   if (!named.blobs.contains(sha256)) Print("nothing names it");
//
// Not thread-safe.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "core/store/catalog.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal {

struct NamedData {
  // Adds what a record names. DATA_LOST if it cannot be parsed.
  absl::Status Take(Table table, const CatalogEntry& entry);

  // SHA-256 of the blobs.
  std::set<std::string> blobs;
  // Those of them that list the trials of a dataset version.
  std::set<std::string> manifests;
  // Finished ones, too; these have no file.
  std::vector<v1::StoredUpload> uploads;
  // Ids of the operations that have not ended.
  std::set<std::string> live_jobs;
};

// Calls `visit` for each record of a table, in the order of the keys, and holds
// few of them in memory. Each is read once; the catalogue may change between
// two. Ends with the first error.
absl::Status VisitEntries(
    const Catalog& catalog, Table table,
    absl::FunctionRef<absl::Status(const CatalogEntry&)> visit);

}  // namespace tactus::internal
