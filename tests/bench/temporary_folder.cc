#include "tests/bench/temporary_folder.h"

#include <stdlib.h>

#include <filesystem>
#include <system_error>

#include "core/base/errors.h"

namespace tactus::internal::client {

absl::StatusOr<TemporaryFolder> TemporaryFolder::Create() {
  std::string path =
      std::filesystem::temp_directory_path() / "tactus-bench-XXXXXX";
  if (mkdtemp(path.data()) == nullptr) {
    return IoError(path, "cannot be created");
  }
  return TemporaryFolder(std::move(path));
}

TemporaryFolder::~TemporaryFolder() {
  if (path_.empty()) return;
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

}  // namespace tactus::internal::client
