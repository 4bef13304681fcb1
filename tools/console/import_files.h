// File: import_files.h
//
// ImportFiles: the files of one import, in a new folder.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto files, ImportFiles::Make(folder));
//   TACTUS_ASSIGN_OR_RETURN(const int file, files->Open("day 1/a.csv", 4711));
//   write(file, bytes, 4711); close(file);
//   files->Has("day 1/a.csv");  // true
//
// Names come from browsers. trainctl names trials by the names of their files,
// and tables name files, so the files have these names; but only names that
// lead nowhere else are taken, a part is opened as a part of the folder before
// it, links are not followed, and no file is opened twice. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::console {

// Says what is wrong with the name of a file, "has a part .."; empty if it may
// be one: parts between slashes that are UTF-8 without control characters and
// do not begin with a point or a hyphen.
std::string ImportNameFault(absl::string_view name);

class ImportFiles {
 public:
  // Makes `folder` and one for the files in it. IO.
  static absl::StatusOr<std::unique_ptr<ImportFiles>> Make(
      const std::string& folder);
  // Leaves the folder as it is.
  ~ImportFiles();

  ImportFiles(const ImportFiles&) = delete;
  ImportFiles& operator=(const ImportFiles&) = delete;

  // Makes a file that will have `bytes` bytes, and returns its descriptor,
  // which the caller closes. INVALID_CONFIG for a name that is wrong or there
  // already, and if the files would be too large or too many. IO.
  absl::StatusOr<int> Open(const std::string& name, int64_t bytes);
  bool Has(const std::string& name) const { return files_.contains(name); }

  const std::string& folder() const { return folder_; }
  // Where the files lie.
  std::string Source() const { return folder_ + "/files"; }

 private:
  ImportFiles(std::string folder, int source)
      : folder_(std::move(folder)), source_(source) {}

  absl::Status Check(const std::string& name, int64_t bytes) const;

  const std::string folder_;
  const int source_;
  std::map<std::string, int64_t> files_;
  int64_t bytes_ = 0;
};

}  // namespace tactus::internal::console
