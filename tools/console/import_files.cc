#include "tools/console/import_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal::console {
namespace {

// A file or folder in an open folder.
int OpenIn(int folder, const std::string& name, int flags) {
  return openat(folder, name.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0600);
}

}  // namespace

std::string ImportNameFault(absl::string_view name) {
  const std::vector<absl::string_view> parts = absl::StrSplit(name, '/');
  if (parts.size() > limits::kMaxImportNameParts) {
    return absl::StrCat("has ", parts.size(), " parts; it must have at most ",
                        limits::kMaxImportNameParts);
  }
  for (const absl::string_view part : parts) {
    if (part.empty()) return "has an empty part";
    if (part.front() == '.' || part.front() == '-') {
      return absl::StrCat("begins a part with ", part.substr(0, 1));
    }
    const std::string fault = TextFault(part, limits::kMaxImportNamePartBytes);
    if (!fault.empty()) return fault;
  }
  return "";
}

absl::StatusOr<std::unique_ptr<ImportFiles>> ImportFiles::Make(
    const std::string& folder) {
  const std::string source = folder + "/files";
  int opened = -1;
  if (mkdir(folder.c_str(), 0700) == 0 && mkdir(source.c_str(), 0700) == 0) {
    opened =
        open(source.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  }
  if (opened < 0) return IoError("folder of the import", std::strerror(errno));
  return std::unique_ptr<ImportFiles>(new ImportFiles(folder, opened));
}

ImportFiles::~ImportFiles() { close(source_); }

absl::Status ImportFiles::Check(const std::string& name, int64_t bytes) const {
  const std::string fault = ImportNameFault(name);
  if (!fault.empty()) {
    return InvalidConfig("name of a file", Quoted(name),
                         absl::StrCat("another one, because it ", fault));
  }
  if (Has(name)) {
    return InvalidConfig("name of a file", Quoted(name),
                         "another one, because it is there already");
  }
  if (bytes > limits::kMaxImportFileBytes) {
    return InvalidConfig(absl::StrCat("bytes of ", Quoted(name)), bytes,
                         absl::StrCat("at most ", limits::kMaxImportFileBytes));
  }
  if (bytes_ + bytes > limits::kMaxImportBytes) {
    return InvalidConfig("bytes of all files", bytes_ + bytes,
                         absl::StrCat("at most ", limits::kMaxImportBytes));
  }
  if (files_.size() >= limits::kMaxImportFiles) {
    return InvalidConfig("files of an import", files_.size() + 1,
                         absl::StrCat("at most ", limits::kMaxImportFiles));
  }
  return absl::OkStatus();
}

absl::StatusOr<int> ImportFiles::Open(const std::string& name, int64_t bytes) {
  TACTUS_RETURN_IF_ERROR(Check(name, bytes));
  std::vector<std::string> parts = absl::StrSplit(name, '/');
  const std::string last = std::move(parts.back());
  parts.pop_back();
  int folder = fcntl(source_, F_DUPFD_CLOEXEC, 0);
  for (const std::string& part : parts) {
    const int above = folder;
    mkdirat(above, part.c_str(), 0700);
    folder = OpenIn(above, part, O_RDONLY | O_DIRECTORY);
    close(above);
  }
  const int file = OpenIn(folder, last, O_WRONLY | O_CREAT | O_EXCL);
  const int error = errno;
  close(folder);
  if (file < 0) return IoError(Quoted(name), std::strerror(error));
  files_.emplace(name, bytes);
  bytes_ += bytes;
  return file;
}

}  // namespace tactus::internal::console
