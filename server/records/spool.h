// File: spool.h
//
// Spool: bytes that arrive in parts, kept in a file until all of them are
// there, so that a slow or busy caller holds no memory.
//
//   TACTUS_ASSIGN_OR_RETURN(const auto spool, Spool::Create(data));
//   TACTUS_RETURN_IF_ERROR(spool->Append(part));
//   TACTUS_ASSIGN_OR_RETURN(const std::string bytes, spool->Read());
//
// The file is a draft of the blob store: it goes with the spool, or when the
// data directory is opened again. Not thread-safe; `data` must outlive it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"

namespace tactus::internal::server {

class Spool {
 public:
  static absl::StatusOr<std::unique_ptr<Spool>> Create(
      const DataDirectory& data);
  ~Spool();

  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  absl::Status Append(absl::string_view bytes);
  // Bytes that were appended.
  int64_t size() const { return size_; }
  // All of them.
  absl::StatusOr<std::string> Read() const;

 private:
  Spool(const DataDirectory& data, std::string path,
        std::unique_ptr<AppendableFile> file)
      : data_(data), path_(std::move(path)), file_(std::move(file)) {}

  const DataDirectory& data_;
  const std::string path_;
  const std::unique_ptr<AppendableFile> file_;
  int64_t size_ = 0;
};

}  // namespace tactus::internal::server
