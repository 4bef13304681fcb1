#include "core/store/disk_use.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;

int64_t SizeOf(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  return error ? 0 : static_cast<int64_t>(size);
}

// Size of all files below `folder`.
int64_t BytesBelow(const fs::path& folder) {
  std::error_code error;
  int64_t bytes = 0;
  auto entry = fs::recursive_directory_iterator(
      folder, fs::directory_options::skip_permission_denied, error);
  while (!error && entry != fs::recursive_directory_iterator()) {
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) bytes += SizeOf(entry->path());
    entry.increment(error);
  }
  return bytes;
}

}  // namespace

v1::DataUse MeasureData(const std::string& folder) {
  const fs::path path(folder);
  v1::DataUse use;
  use.set_folder(folder);
  use.set_blob_bytes(BytesBelow(path / "blobs"));
  use.set_upload_bytes(BytesBelow(path / "uploads"));
  use.set_job_bytes(BytesBelow(path / "jobs"));
  use.set_catalog_bytes(SizeOf(path / "catalog.db") +
                        SizeOf(path / "catalog.db-wal") +
                        SizeOf(path / "catalog.db-shm"));
  use.set_free_bytes(std::max(int64_t{0}, FreeBytes(folder)));
  return use;
}

int64_t FreeBytes(const std::string& folder) {
  std::error_code error;
  const auto space = fs::space(folder, error);
  return error ? -1 : static_cast<int64_t>(space.available);
}

}  // namespace tactus::internal
