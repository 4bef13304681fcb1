// File: pack_reader.h
//
// PackReader: reads a trial pack from a file, one record at a time.
//
//   PackReader pack(files, path, size);
//   while (!pack.AtEnd()) {
//     TACTUS_ASSIGN_OR_RETURN(const std::string record, pack.Next());
//   }
//
// Holds one record in memory. Not thread-safe. `files` must outlive it.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/store/file_system.h"

namespace tactus::server {

class PackReader {
 public:
  // `size`: bytes of the pack.
  PackReader(FileSystem& files, std::string path, int64_t size)
      : files_(files), path_(std::move(path)), size_(size) {}

  bool AtEnd() const { return offset_ == size_; }
  // The bytes of the next record. INVALID_TRIAL if the pack is cut short or
  // announces a record that is empty or too large.
  absl::StatusOr<std::string> Next();

 private:
  FileSystem& files_;
  const std::string path_;
  const int64_t size_;
  int64_t offset_ = 0;
  int64_t records_ = 0;
};

}  // namespace tactus::server
