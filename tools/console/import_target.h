// File: import_target.h
//
// The addresses of imports:
//
//   POST /api/import/<server>/begin?replace=<1 or nothing>
//   POST /api/import/<server>/file?id=<import>&name=<name>   a file
//   POST /api/import/<server>/check?id=<import>              ReadOptions
//   POST /api/import/<server>/finish?id=<import>             SendOptions
//   POST /api/import/<server>/end?id=<import>
//
//   const auto target =
//       FindImportStep("/api/import/0/file?id=7f&name=a%20b.csv");
//   target->name;  // "a b.csv"
//
// Thread-safe: free functions without state.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal::console {

enum class ImportStep { kBegin, kFile, kCheck, kFinish, kEnd };

struct ImportTarget {
  ImportStep step = ImportStep::kBegin;
  // The number of the server.
  size_t server = 0;
  std::string id;
  std::string name;
  // The person's other import ends.
  bool replaces = false;
};

// True if an address is one of these, with a step that exists or not.
bool IsImport(absl::string_view target);

// None if there is no such step, or its parts are wrong.
std::optional<ImportTarget> FindImportStep(absl::string_view target);

}  // namespace tactus::internal::console
