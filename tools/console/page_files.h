// File: page_files.h
//
// The files of the page, in memory.
//
//   TACTUS_ASSIGN_OR_RETURN(const PageFiles files, ReadPageFiles(folder));
//   const PageFile* file = FindPageFile(files, "/app.js");
//
// Only files that are known by name are read, so no path of a request reaches
// the file system. Plain data. Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::console {

struct PageFile {
  // The path of a request, like "/app.js".
  std::string target;
  std::string content_type;
  std::string bytes;
};

using PageFiles = std::vector<PageFile>;

// IO that names a file that is missing or too large.
absl::StatusOr<PageFiles> ReadPageFiles(const std::string& folder);

// Null if there is no such file. "/" is "/index.html".
const PageFile* FindPageFile(const PageFiles& files, absl::string_view target);

}  // namespace tactus::internal::console
