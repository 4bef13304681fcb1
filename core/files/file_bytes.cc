#include "core/files/file_bytes.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal {

absl::StatusOr<std::string> ReadFileBytes(const std::string& path,
                                          size_t limit) {
  std::error_code error;
  const uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) return IoError(path, error.message());
  if (bytes > limit) {
    return TrialFileInvalid(
        path, absl::StrCat("has ", bytes, " bytes; the limit is ", limit));
  }
  std::string content(bytes, '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(content.data(), static_cast<std::streamsize>(bytes))) {
    return IoError(path, "cannot be read");
  }
  return content;
}

}  // namespace tactus::internal
