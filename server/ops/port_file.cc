#include "server/ops/port_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal::server {

absl::Status WritePortFile(const std::string& path, int port) {
  const std::string draft = absl::StrCat(path, ".", getpid());
  {
    std::ofstream file(draft);
    file << port << "\n";
    file.close();
    if (!file) return IoError(draft, std::strerror(errno));
  }
  if (std::rename(draft.c_str(), path.c_str()) != 0) {
    const int error = errno;
    std::remove(draft.c_str());
    return IoError(path, std::strerror(error));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
