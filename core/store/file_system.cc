#include "core/store/file_system.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

absl::StatusOr<std::string> ReadWhole(FileSystem& files,
                                      const std::string& path, int64_t limit) {
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files.Size(path));
  if (size < 0) return DataLost(path, "the file does not exist");
  if (size > limit) {
    return DataLost(path, absl::StrCat("has ", size,
                                       " bytes; it must have at most ", limit));
  }
  return files.Read(path, 0, size);
}

absl::Status WriteAtomically(FileSystem& files, const std::string& path,
                             absl::string_view bytes) {
  const std::string draft = path + ".draft";
  TACTUS_RETURN_IF_ERROR(files.Remove(draft));
  {
    TACTUS_ASSIGN_OR_RETURN(const auto file, files.Append(draft));
    TACTUS_RETURN_IF_ERROR(file->Append(bytes));
    TACTUS_RETURN_IF_ERROR(file->Sync());
  }
  TACTUS_RETURN_IF_ERROR(files.Rename(draft, path));
  return files.SyncDirectory(path.substr(0, path.rfind('/')));
}

}  // namespace tactus::internal
