#include "core/store/directory_identity.h"

#include <sys/random.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

constexpr char kId[] = "id";
constexpr char kStarts[] = "starts";
constexpr size_t kIdBytes = 16;
constexpr int64_t kMaxMarkerBytes = 1'000;

struct Identity {
  // Empty if it is not known.
  std::string id;
  uint64_t starts = 0;
};

std::string MarkerPath(const std::string& folder) { return folder + "/marker"; }

// Nothing if there is no marker.
absl::StatusOr<std::optional<Identity>> ReadMarker(FileSystem& files,
                                                   const std::string& folder) {
  const std::string path = MarkerPath(folder);
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files.Size(path));
  if (size < 0) return std::nullopt;
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadWhole(files, path, kMaxMarkerBytes));
  const std::vector<std::string> words =
      absl::StrSplit(text, absl::ByAnyChar(" \n"), absl::SkipEmpty());
  Identity identity;
  // A damaged marker still says that the folder was used.
  if (words.size() == 2 && words[0].size() == 2 * kIdBytes &&
      absl::SimpleAtoi(words[1], &identity.starts)) {
    identity.id = words[0];
  }
  return identity;
}

absl::StatusOr<Identity> ReadIdentity(const Transaction& look) {
  Identity identity;
  TACTUS_ASSIGN_OR_RETURN(const auto id, look.Get(Table::kDirectory, kId));
  TACTUS_ASSIGN_OR_RETURN(const auto starts,
                          look.Get(Table::kDirectory, kStarts));
  identity.id = id.value_or("");
  if (starts.has_value() && !absl::SimpleAtoi(*starts, &identity.starts)) {
    return DataLost(kStarts, "the number of starts is not a number");
  }
  return identity;
}

absl::StatusOr<Identity> ReadIdentity(const Catalog& catalog) {
  Identity identity;
  TACTUS_RETURN_IF_ERROR(
      catalog.Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(identity, ReadIdentity(look));
        return absl::OkStatus();
      }));
  return identity;
}

// Every change has an entry in the audit log.
absl::StatusOr<bool> HasRecords(const Catalog& catalog) {
  bool found = false;
  TACTUS_RETURN_IF_ERROR(
      catalog.Look([&](const Transaction& look) -> absl::Status {
        for (const Table table :
             {Table::kAudit, Table::kDatasets, Table::kModelVersions}) {
          TACTUS_ASSIGN_OR_RETURN(const auto some,
                                  look.Scan(table, {.limit = 1}));
          found |= !some.empty();
        }
        return absl::OkStatus();
      }));
  return found;
}

absl::Status Refuse(const std::string& folder, absl::string_view what) {
  return WithRestoreAdvice(folder, DataLost(CatalogPath(folder), what));
}

}  // namespace

std::string CatalogPath(absl::string_view folder) {
  return absl::StrCat(folder, "/catalog.db");
}

absl::Status WithRestoreAdvice(const std::string& folder,
                               const absl::Status& status) {
  if (!absl::IsDataLoss(status)) return status;
  const std::string path = CatalogPath(folder);
  absl::string_view message = status.message();
  absl::ConsumePrefix(&message, path + ": ");
  return DataLost(
      path,
      absl::StrCat(message,
                   ". Put back catalog.db of this directory from a "
                   "back-up and remove catalog.db-wal and "
                   "catalog.db-shm. If there is no back-up: trainctl "
                   "doctor --data-dir=",
                   folder,
                   " --accept-catalogue begins with what is there, and keeps "
                   "all blobs"));
}

int CountData(FileSystem& files, const std::string& folder) {
  const std::vector<std::string> none;
  const std::string blobs = folder + "/blobs";
  int count =
      static_cast<int>(files.List(folder + "/uploads").value_or(none).size());
  for (const std::string& shelf : files.List(blobs).value_or(none)) {
    const auto names =
        files.List(absl::StrCat(blobs, "/", shelf)).value_or(none);
    count += static_cast<int>(std::count_if(
        names.begin(), names.end(),
        [](const std::string& name) { return IsSha256Hex(name); }));
  }
  return count;
}

absl::StatusOr<std::string> NewId() {
  std::string bytes(kIdBytes, '\0');
  if (getrandom(bytes.data(), bytes.size(), 0) !=
      static_cast<ssize_t>(bytes.size())) {
    return IoError("getrandom", std::strerror(errno));
  }
  return absl::BytesToHexString(bytes);
}

absl::StatusOr<std::string> DirectoryIdOf(const Catalog& catalog) {
  TACTUS_ASSIGN_OR_RETURN(Identity is, ReadIdentity(catalog));
  return std::move(is.id);
}

absl::StatusOr<bool> DirectoryWasUsed(FileSystem& files,
                                      const std::string& folder) {
  TACTUS_ASSIGN_OR_RETURN(const auto marker, ReadMarker(files, folder));
  return marker.has_value() || CountData(files, folder) > 0;
}

absl::Status CheckCatalogFile(FileSystem& files, const std::string& folder) {
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, files.Size(CatalogPath(folder)));
  if (size > 0) return absl::OkStatus();
  const char* const is = size < 0 ? "is missing" : "is empty";
  TACTUS_ASSIGN_OR_RETURN(const auto marker, ReadMarker(files, folder));
  const int data = CountData(files, folder);
  if (!marker.has_value() && data == 0) return absl::OkStatus();
  return Refuse(folder, absl::StrCat("the catalogue ", is,
                                     ", but the directory was used: it holds ",
                                     data, " blobs and uploads"));
}

absl::Status CheckCatalogBelongs(FileSystem& files, const std::string& folder,
                                 const Catalog& catalog) {
  TACTUS_ASSIGN_OR_RETURN(const auto marker, ReadMarker(files, folder));
  TACTUS_ASSIGN_OR_RETURN(const Identity is, ReadIdentity(catalog));
  if (!is.id.empty()) {
    if (!marker.has_value() || marker->id.empty() || marker->id == is.id) {
      return absl::OkStatus();
    }
    return Refuse(folder,
                  absl::StrCat("the catalogue belongs to the directory ", is.id,
                               ", and this is ", marker->id));
  }
  TACTUS_ASSIGN_OR_RETURN(const bool has_records, HasRecords(catalog));
  if (has_records) {
    if (!marker.has_value()) return absl::OkStatus();
    return Refuse(folder,
                  absl::StrCat("the catalogue does not say which directory it "
                               "belongs to, and this is ",
                               marker->id));
  }
  const int data = CountData(files, folder);
  if (!marker.has_value() && data == 0) return absl::OkStatus();
  return Refuse(folder, absl::StrCat("the catalogue has no records, but the "
                                     "directory was used: it holds ",
                                     data, " blobs and uploads"));
}

absl::StatusOr<bool> CatalogIsOlder(FileSystem& files,
                                    const std::string& folder,
                                    const Catalog& catalog) {
  TACTUS_ASSIGN_OR_RETURN(const auto marker, ReadMarker(files, folder));
  TACTUS_ASSIGN_OR_RETURN(const Identity is, ReadIdentity(catalog));
  return marker.has_value() && is.starts < marker->starts;
}

absl::Status MarkDirectory(FileSystem& files, const std::string& folder,
                           Catalog& catalog) {
  TACTUS_ASSIGN_OR_RETURN(auto marker, ReadMarker(files, folder));
  Identity next;
  TACTUS_RETURN_IF_ERROR(
      catalog.Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(next, ReadIdentity(change));
        if (marker.has_value()) {
          if (!marker->id.empty()) next.id = marker->id;
          next.starts = std::max(next.starts, marker->starts);
        }
        if (next.id.empty()) {
          TACTUS_ASSIGN_OR_RETURN(next.id, NewId());
        }
        ++next.starts;
        TACTUS_RETURN_IF_ERROR(change.Put(Table::kDirectory, kId, next.id));
        return change.Put(Table::kDirectory, kStarts,
                          absl::StrCat(next.starts));
      }));
  // The names of the catalogue's files: a folder with a marker has them.
  TACTUS_RETURN_IF_ERROR(files.SyncDirectory(folder));
  return WriteAtomically(files, MarkerPath(folder),
                         absl::StrCat(next.id, " ", next.starts, "\n"));
}

}  // namespace tactus::internal
