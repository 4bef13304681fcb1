#include "server/trainer/file_journal.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kMaxPartBytes = 1024L * 1024 * 1024;
// File systems take 255 bytes; WriteAtomically needs some of them.
constexpr size_t kMaxNameBytes = 200;

}  // namespace

std::string FileJournal::PathOf(absl::string_view part) const {
  std::string name;
  for (const char c : part) {
    if (c == '/') {
      name += '_';
    } else if (absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-') {
      name += c;
    } else {
      absl::StrAppend(
          &name, "%",
          absl::Hex(static_cast<unsigned char>(c), absl::kZeroPad2));
    }
  }
  if (name.size() > kMaxNameBytes) name = Sha256Hex(part);
  return absl::StrCat(folder_, "/", name);
}

std::optional<std::string> FileJournal::Find(absl::string_view part) {
  const std::string path = PathOf(part);
  const auto size = files_.Size(path);
  if (!size.ok() || *size < 0) return std::nullopt;
  auto bytes = ReadWhole(files_, path, kMaxPartBytes);
  if (!bytes.ok()) return std::nullopt;
  return *std::move(bytes);
}

absl::Status FileJournal::Put(absl::string_view part, std::string bytes) {
  return WriteAtomically(files_, PathOf(part), bytes);
}

void FileJournal::OnPoint(const LearningPoint& point) { events_->Send(point); }

}  // namespace tactus::internal::server
