// File: shared_data.h
//
// What servers share, for commands that work on it themselves: a catalogue in
// PostgreSQL and a folder.
//
//   SharedDataFlags flags;
//   flags.Add(*command, "--catalog", "--blobs");
//   TACTUS_ASSIGN_OR_RETURN(auto catalog,
//                           OpenExistingPostgresCatalog(flags.catalog));
//   TACTUS_ASSIGN_OR_RETURN(const auto servers, ServersAtWork(*catalog));
//
// The command line writes to the flags. Not thread-safe.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "absl/status/statusor.h"
#include "core/store/catalog.h"

namespace tactus::internal::client {

struct SharedDataFlags {
  std::string catalog;
  std::string blobs;

  // Both flags, which need each other. Returns that of the catalogue.
  CLI::Option* Add(CLI::App& command, const std::string& catalog_flag,
                   const std::string& blobs_flag);
  bool given() const { return !catalog.empty(); }
};

// The servers and workers that live, for people. Waits for some seconds if any
// has not ended as it should.
absl::StatusOr<std::vector<std::string>> ServersAtWork(const Catalog& catalog);

}  // namespace tactus::internal::client
