// File: mistakes.h
//
// Mistakes: the mistakes of a set of files as one error.
//
//   Mistakes mistakes("trials.csv");
//   for (const auto& [file, status] : read) {
//     TACTUS_RETURN_IF_ERROR(mistakes.Add(file, status));
//   }
//   TACTUS_RETURN_IF_ERROR(mistakes.Status());
//
// Not thread-safe.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

class Mistakes {
 public:
  // `path` is the table of the set.
  explicit Mistakes(std::string path) : path_(std::move(path)) {}

  // Keeps an error about `file`; OK is none. Returns an error that is about no
  // file, because it ends the import.
  absl::Status Add(const std::string& file, const absl::Status& status);
  bool empty() const { return count_ == 0; }
  // OK without mistakes; one mistake as it is; else TRIAL_FILE_INVALID with the
  // first 20 kinds of mistakes, the first 20 files of each, and how many there
  // are.
  absl::Status Status() const;

 private:
  const std::string path_;
  absl::Status first_;
  // A mistake, and where it was made again.
  struct Kind {
    std::string text;
    std::vector<std::string> again;
    size_t more = 0;
  };
  std::vector<Kind> kinds_;
  // The place in kinds_ of a mistake without its file and line.
  std::map<std::string, size_t> places_;
  size_t count_ = 0;
  size_t not_shown_ = 0;
};

}  // namespace tactus::internal
