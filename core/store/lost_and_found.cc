#include "core/store/lost_and_found.h"

#include <algorithm>
#include <cstdint>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace tactus::internal {

absl::Status LostAndFound::MakeFolder() {
  const std::string all = data_folder_ + "/lost+found";
  TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(all));
  TACTUS_ASSIGN_OR_RETURN(const auto names, files_.List(all));
  uint64_t last = 0;
  for (const std::string& name : names) {
    uint64_t number = 0;
    if (absl::SimpleAtoi(name, &number)) last = std::max(last, number);
  }
  const std::string folder = absl::StrCat(all, "/", last + 1);
  TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(folder));
  folder_ = folder;
  return absl::OkStatus();
}

absl::Status LostAndFound::Take(const std::string& path) {
  if (folder_.empty()) TACTUS_RETURN_IF_ERROR(MakeFolder());
  for (size_t slash = path.find('/'); slash != std::string::npos;
       slash = path.find('/', slash + 1)) {
    TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(
        absl::StrCat(folder_, "/", path.substr(0, slash))));
  }
  return files_.Rename(absl::StrCat(data_folder_, "/", path),
                       absl::StrCat(folder_, "/", path));
}

}  // namespace tactus::internal
