// File: tables.h
//
// The tables of a catalogue by name.
//
//   for (const auto& [table, name] : kTables) Print(name);
//
// Constants without state.
#pragma once

#include <utility>

#include "core/store/catalog.h"

namespace tactus::internal {

// All tables, with a word for what is in them.
inline constexpr std::pair<Table, const char*> kTables[] = {
    {Table::kDatasets, "datasets"},
    {Table::kDatasetVersions, "dataset versions"},
    {Table::kTrials, "trials"},
    {Table::kUploads, "uploads"},
    {Table::kOperations, "operations"},
    {Table::kLearningPoints, "learning curves"},
    {Table::kModelVersions, "model versions"},
    {Table::kAliases, "aliases"},
    {Table::kAliasChanges, "alias histories"},
    {Table::kRequests, "requests"},
    {Table::kAudit, "audit log"},
    {Table::kNumbers, "numbers"},
    {Table::kJobLogs, "job logs"},
    {Table::kDirectory, "data directory"},
    {Table::kReplicas, "replicas"},
    {Table::kLeases, "leases"},
    {Table::kBeats, "signs of life"},
};

}  // namespace tactus::internal
