#include "tools/console/page_files.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limits_console.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::console {
namespace {

struct KnownFile {
  absl::string_view name;
  absl::string_view content_type;
};

constexpr KnownFile kKnownFiles[] = {
    {"index.html", "text/html; charset=utf-8"},
    {"app.js", "text/javascript; charset=utf-8"},
    {"app.css", "text/css; charset=utf-8"},
    {"favicon.svg", "image/svg+xml"},
};

}  // namespace

absl::StatusOr<PageFiles> ReadPageFiles(const std::string& folder) {
  PageFiles files;
  for (const KnownFile& known : kKnownFiles) {
    TACTUS_ASSIGN_OR_RETURN(std::string bytes,
                            ReadFileBytes(absl::StrCat(folder, "/", known.name),
                                          limits::kMaxPageFileBytes));
    files.push_back({.target = absl::StrCat("/", known.name),
                     .content_type = std::string(known.content_type),
                     .bytes = std::move(bytes)});
  }
  return files;
}

const PageFile* FindPageFile(const PageFiles& files, absl::string_view target) {
  if (target == "/") target = "/index.html";
  const auto file = std::ranges::find(files, target, &PageFile::target);
  return file == files.end() ? nullptr : &*file;
}

}  // namespace tactus::internal::console
