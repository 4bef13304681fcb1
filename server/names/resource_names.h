// File: resource_names.h
//
// Names of what the server keeps: "datasets/D", "datasets/D/versions/V",
// "uploads/U", "operations/O", "models/M", "models/M/versions/V", "aliases/A".
// D, M and A are 1 to 64 of a-z, 0-9 and -; U, O and V are numbers from 1.
//
//   TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
//                           ParseName("datasets/grasps/versions/2",
//                           "datasets"));
//   CatalogKey(name);  // "grasps/0000000002"
//
// Only names that were parsed become keys and parts of paths. Thread-safe: free
// functions without state.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/numbers.h"

namespace tactus::internal::server {

struct ResourceName {
  // "datasets", "uploads", "operations", "models" or "aliases".
  std::string collection;
  // The part behind it.
  std::string id;
  // 0 if the name has no version.
  uint32_t version = 0;

  // "datasets/D", without the version.
  std::string Parent() const;
  // The whole name.
  std::string ToString() const;
};

// True for 1 to 64 of a-z, 0-9 and -.
bool IsResourceId(absl::string_view id);

// INVALID_NAME for any other text, or for a name of another collection.
absl::StatusOr<ResourceName> ParseName(absl::string_view name,
                                       absl::string_view collection);

// As ParseName, but the name must have a version.
absl::StatusOr<ResourceName> ParseVersionName(absl::string_view name,
                                              absl::string_view collection);

// The key under which a catalogue keeps it: numbers sort by their value.
std::string CatalogKey(const ResourceName& name);

}  // namespace tactus::internal::server
