#include "core/store/data_check.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/bytes_text.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/store/abandoned_uploads.h"
#include "core/store/accept_catalog.h"
#include "core/store/blob_store.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_lock.h"
#include "core/store/disk_use.h"
#include "core/store/lost_and_found.h"
#include "core/store/records.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal {
namespace {

using Severity = CheckResult::Severity;
using v1::Operation;

constexpr int64_t kLittleBytes = 1024L * 1024 * 1024;
constexpr int64_t kNoBytes = 64L * 1024 * 1024;
constexpr size_t kShownNames = 3;
constexpr char kRights[] =
    "run this as the user that runs the server, on a file system that can be "
    "written";
constexpr char kRestore[] = "restore the directory from a back-up";
constexpr char kRepair[] =
    "run trainctl doctor with --repair to move them to lost+found";

std::string Message(const absl::Status& status) {
  return std::string(status.message());
}

// The first names of a list, and how many there are.
std::string NamesOf(const std::vector<std::string>& names) {
  const size_t shown = std::min(names.size(), kShownNames);
  std::string text = absl::StrJoin(
      names.begin(), names.begin() + static_cast<long>(shown), ", ");
  if (names.size() > shown) absl::StrAppend(&text, ", ...");
  return text;
}

class DataCheck {
 public:
  DataCheck(FileSystem& files, const std::string& folder,
            const DataCheckOptions& options)
      : files_(files),
        folder_(folder),
        options_(options),
        lost_(files, folder) {}

  std::vector<CheckResult> Run() {
    CheckFreeBytes();
    if (Lock() && (!options_.accept_catalog || Accept()) && OpenCatalog()) {
      ReadRecords();
      CheckBlobs();
      CheckOrphans();
      CheckUploads();
      CheckJobs();
      CheckLostAndFound();
    }
    return std::move(results_);
  }

 private:
  void Add(const char* check, Severity severity, std::string text,
           std::string advice = "") {
    results_.push_back({check, severity, std::move(text), std::move(advice)});
  }

  void CheckFreeBytes() {
    const int64_t bytes =
        options_.free_bytes ? options_.free_bytes(folder_) : FreeBytes(folder_);
    const Severity severity = bytes < kNoBytes       ? Severity::kError
                              : bytes < kLittleBytes ? Severity::kWarning
                                                     : Severity::kOk;
    Add("free disk", severity,
        bytes < 0 ? "unknown" : absl::StrCat(BytesText(bytes), " are free"),
        severity == Severity::kOk
            ? ""
            : "delete datasets that nobody needs, or move the directory to a "
              "larger disk");
  }

  bool Lock() {
    const auto marker = files_.Size(folder_ + "/marker");
    const auto size = files_.Size(CatalogPath(folder_));
    const auto blobs = files_.List(folder_ + "/blobs");
    if (!blobs.ok() && (!marker.ok() || *marker < 0) &&
        (!size.ok() || *size < 0)) {
      Add("catalogue", Severity::kError,
          absl::StrCat(CatalogPath(folder_), " does not exist"),
          "give the folder that tactusd got as --data-dir");
      return false;
    }
    auto lock = DirectoryLock::Take(folder_);
    if (!lock.ok()) {
      const bool in_use = DirectoryLock::IsInUse(lock.status());
      Add("lock", in_use ? Severity::kWarning : Severity::kError,
          Message(lock.status()),
          in_use
              ? "stop the server to check its files, or ask it with trainctl "
                "doctor --server"
              : kRights);
      return false;
    }
    lock_ = *std::move(lock);
    Add("lock", Severity::kOk, "no server uses the directory");
    return true;
  }

  bool Accept() {
    const auto done = AcceptCatalog(files_, folder_);
    if (!done.ok()) {
      Add("catalogue", Severity::kError, Message(done.status()), kRights);
      return false;
    }
    Add("catalogue", Severity::kOk, "accepted: " + *done);
    return true;
  }

  bool OpenCatalog() {
    const std::string path = CatalogPath(folder_);
    absl::Status status = CheckCatalogFile(files_, folder_);
    if (!status.ok()) return Refuse(status);
    const auto version = CatalogVersionOf(path);
    if (!version.ok()) {
      return Refuse(WithRestoreAdvice(folder_, version.status()));
    }
    const auto used = DirectoryWasUsed(files_, folder_);
    if (!used.ok()) return Refuse(used.status());
    if (*version == 0 && *used) {
      return Refuse(WithRestoreAdvice(
          folder_, DataLost(path, "has no version, so no server wrote it")));
    }
    if (*version != kCatalogVersion) {
      const bool newer = *version > kCatalogVersion;
      Add("catalogue", newer ? Severity::kError : Severity::kWarning,
          absl::StrCat("has version ", *version, "; this program has version ",
                       kCatalogVersion),
          newer ? "use the trainctl of the same release as the server"
                : "start the server once: it brings the catalogue up to date");
      return false;
    }
    auto catalog = OpenSqliteCatalog(path);
    status = catalog.status();
    if (status.ok()) status = (*catalog)->Check();
    if (!status.ok()) return Refuse(WithRestoreAdvice(folder_, status));
    catalog_ = *std::move(catalog);
    status = CheckCatalogBelongs(files_, folder_, *catalog_);
    if (!status.ok()) return Refuse(status);
    const auto older = CatalogIsOlder(files_, folder_, *catalog_);
    if (!older.ok()) return Refuse(older.status());
    if (*older) {
      Add("catalogue", Severity::kWarning,
          "is older than the directory: it is a copy, or its write-ahead log "
          "was lost",
          "nothing, if a back-up was restored: what was stored since is named "
          "by no record, and the next start of the server accepts that");
      return true;
    }
    Add("catalogue", Severity::kOk,
        absl::StrCat("version ", *version,
                     ", its structure is intact, and its records are those "
                     "that the server wrote"));
    return true;
  }

  // False.
  bool Refuse(const absl::Status& status) {
    Add("catalogue", Severity::kError, Message(status),
        absl::IsDataLoss(status) ? "" : kRights);
    return false;
  }

  // Every record has its CRC32C, and can be parsed if it names something.
  void ReadRecords() {
    size_t records = 0;
    for (const auto& [table, name] : kTables) {
      const absl::Status status = catalog_->Look(
          [&, table = table](const Transaction& look) -> absl::Status {
            TACTUS_ASSIGN_OR_RETURN(const auto entries, look.Scan(table, {}));
            records += entries.size();
            for (const CatalogEntry& entry : entries) {
              TACTUS_RETURN_IF_ERROR(Take(table, entry));
            }
            return absl::OkStatus();
          });
      if (status.ok()) continue;
      complete_ = false;
      Add("records", Severity::kError,
          absl::StrCat(name, ": ", status.message()), kRestore);
    }
    if (complete_) {
      Add("records", Severity::kOk,
          absl::StrCat(records, " records have their CRC32C"));
    }
  }

  absl::Status Take(Table table, const CatalogEntry& entry) {
    switch (table) {
      case Table::kTrials:
        named_.insert(entry.key);
        return absl::OkStatus();
      case Table::kDatasetVersions: {
        TACTUS_ASSIGN_OR_RETURN(
            const auto version,
            ParseRecord<v1::DatasetVersion>(entry.key, entry.value));
        named_.insert(version.sha256());
        manifests_.insert(version.sha256());
        return absl::OkStatus();
      }
      case Table::kModelVersions: {
        TACTUS_ASSIGN_OR_RETURN(
            const auto version,
            ParseRecord<v1::ModelVersion>(entry.key, entry.value));
        if (!version.blob_sha256().empty()) {
          named_.insert(version.blob_sha256());
        }
        return absl::OkStatus();
      }
      case Table::kUploads: {
        TACTUS_ASSIGN_OR_RETURN(
            auto upload, ParseRecord<v1::StoredUpload>(entry.key, entry.value));
        uploads_.push_back(std::move(upload));
        return absl::OkStatus();
      }
      case Table::kOperations: {
        TACTUS_ASSIGN_OR_RETURN(const auto operation,
                                ParseRecord<Operation>(entry.key, entry.value));
        const bool ended = operation.state() == Operation::STATE_SUCCEEDED ||
                           operation.state() == Operation::STATE_FAILED ||
                           operation.state() == Operation::STATE_CANCELLED;
        const std::pair<std::string, std::string> parts =
            absl::StrSplit(operation.name(), absl::MaxSplits('/', 1));
        if (!ended) live_jobs_.insert(parts.second);
        return absl::OkStatus();
      }
      default:
        return absl::OkStatus();
    }
  }

  std::string PathOfBlob(const std::string& sha256) const {
    return BlobPath(absl::StrCat(folder_, "/blobs"), sha256);
  }

  void CheckBlobs() {
    std::vector<std::string> bad;
    // Manifests name trials, which the catalogue names too.
    std::set<std::string> trials;
    for (const std::string& sha256 : named_) {
      const std::string path = PathOfBlob(sha256);
      const auto size = files_.Size(path);
      if (!size.ok() || *size < 0) {
        bad.push_back(absl::StrCat(sha256, " is missing"));
        continue;
      }
      const auto bytes = ReadBlobFile(files_, path, sha256, *size);
      if (!bytes.ok()) {
        bad.push_back(absl::StrCat(sha256, " is damaged"));
        continue;
      }
      if (!manifests_.contains(sha256)) continue;
      for (const auto line : absl::StrSplit(*bytes, '\n', absl::SkipEmpty())) {
        trials.insert(std::string(line));
      }
    }
    if (complete_) {
      for (const std::string& trial : trials) {
        if (!named_.contains(trial)) {
          bad.push_back(absl::StrCat("trial ", trial, " has no record"));
        }
      }
    }
    if (bad.empty()) {
      Add("blobs", Severity::kOk,
          absl::StrCat(named_.size(), " blobs have their SHA-256"));
    } else {
      Add("blobs", Severity::kError,
          absl::StrCat(bad.size(), " of ", named_.size(), ": ", NamesOf(bad)),
          "restore these files from a back-up, or delete what names them");
    }
  }

  // `paths` are unused files or folders. Moves them away if that is wanted.
  void Report(const char* check, const char* what,
              const std::vector<std::string>& paths, int64_t bytes) {
    if (!complete_) {
      Add(check, Severity::kWarning,
          "not checked: records that cannot be read may name what is there",
          kRestore);
      return;
    }
    if (paths.empty()) {
      Add(check, Severity::kOk, absl::StrCat("no ", what));
      return;
    }
    std::string text = absl::StrCat(paths.size(), " ", what, ", ",
                                    BytesText(bytes), ": ", NamesOf(paths));
    if (!options_.repair) {
      Add(check, Severity::kWarning, text, kRepair);
      return;
    }
    absl::Status status;
    for (const std::string& path : paths) {
      status.Update(lost_.Take(path));
    }
    if (status.ok()) {
      Add(check, Severity::kOk,
          absl::StrCat("moved to ", lost_.folder(), ": ", text));
    } else {
      Add(check, Severity::kError, Message(status), kRights);
    }
  }

  // The size of a file, or of the files of a folder.
  int64_t BytesOf(const std::string& path) {
    const auto names = files_.List(path);
    if (!names.ok()) return files_.Size(path).value_or(0);
    int64_t bytes = 0;
    for (const std::string& name : *names) {
      bytes += BytesOf(absl::StrCat(path, "/", name));
    }
    return bytes;
  }

  std::vector<std::string> List(const std::string& path) {
    return files_.List(absl::StrCat(folder_, "/", path))
        .value_or(std::vector<std::string>());
  }

  void CheckOrphans() {
    std::vector<std::string> orphans;
    int64_t bytes = 0;
    for (const std::string& shelf : List("blobs")) {
      const bool drafts = shelf == "drafts";
      for (const std::string& name : List("blobs/" + shelf)) {
        if (!drafts && (!IsSha256Hex(name) || named_.contains(name))) continue;
        orphans.push_back(absl::StrCat("blobs/", shelf, "/", name));
        bytes += BytesOf(absl::StrCat(folder_, "/", orphans.back()));
      }
    }
    Report("orphans", "blobs that nothing names", orphans, bytes);
  }

  void CheckUploads() {
    std::set<std::string> live;
    std::vector<std::string> short_ones;
    std::vector<v1::StoredUpload> abandoned;
    std::vector<std::string> stray;
    for (const v1::StoredUpload& upload : uploads_) {
      if (!upload.dataset_version().empty()) continue;
      const std::string id = UploadFile(upload);
      const std::string path = absl::StrCat("uploads/", id);
      live.insert(id);
      const int64_t size =
          std::max(int64_t{0},
                   files_.Size(absl::StrCat(folder_, "/", path)).value_or(0));
      if (IsAbandoned(upload, options_.now_ms)) {
        abandoned.push_back(upload);
      } else if (size < upload.committed_size()) {
        short_ones.push_back(absl::StrCat(upload.name(), " has ", size, " of ",
                                          upload.committed_size(), " bytes"));
      }
    }
    int64_t stray_bytes = 0;
    for (const std::string& name : List("uploads")) {
      if (live.contains(name)) continue;
      stray.push_back("uploads/" + name);
      stray_bytes += BytesOf(absl::StrCat(folder_, "/", stray.back()));
    }
    if (!short_ones.empty()) {
      Add("uploads", Severity::kError, NamesOf(short_ones),
          "begin these uploads again");
    }
    ReportAbandoned(abandoned);
    Report("stray uploads", "files of uploads that do not wait", stray,
           stray_bytes);
  }

  void ReportAbandoned(const std::vector<v1::StoredUpload>& abandoned) {
    std::vector<std::string> paths;
    int64_t bytes = 0;
    for (const v1::StoredUpload& upload : abandoned) {
      paths.push_back("uploads/" + UploadFile(upload));
      bytes += BytesOf(absl::StrCat(folder_, "/", paths.back()));
    }
    if (options_.repair && complete_ && !abandoned.empty()) {
      const absl::Status status =
          catalog_->Change([&](Transaction& change) -> absl::Status {
            for (const v1::StoredUpload& upload : abandoned) {
              TACTUS_RETURN_IF_ERROR(RemoveUpload(
                  change, upload, "trainctl doctor", options_.now_ms));
            }
            return absl::OkStatus();
          });
      if (!status.ok()) {
        Add("abandoned uploads", Severity::kError, Message(status), kRestore);
        return;
      }
    }
    Report("abandoned uploads", "uploads without a write for 7 days", paths,
           bytes);
  }

  void CheckJobs() {
    std::vector<std::string> folders;
    int64_t bytes = 0;
    for (const std::string& id : List("jobs")) {
      if (live_jobs_.contains(id)) continue;
      folders.push_back("jobs/" + id);
      bytes += BytesOf(absl::StrCat(folder_, "/", folders.back()));
    }
    Report("jobs", "folders of jobs that have ended", folders, bytes);
  }

  // What earlier repairs moved away, and this one.
  void CheckLostAndFound() {
    const std::string path = folder_ + "/lost+found";
    const auto names = files_.List(path);
    if (!names.ok() || names->empty()) return;
    Add("lost+found", Severity::kOk,
        absl::StrCat(BytesOf(path),
                     " bytes that repairs moved away; if nobody "
                     "misses them, delete them by hand: rm -r ",
                     path, "/*"));
  }

  FileSystem& files_;
  const std::string folder_;
  const DataCheckOptions& options_;
  LostAndFound lost_;
  std::vector<CheckResult> results_;
  std::unique_ptr<DirectoryLock> lock_;
  std::unique_ptr<Catalog> catalog_;
  // Every record could be read.
  bool complete_ = true;
  // SHA-256 of the blobs that records name.
  std::set<std::string> named_;
  std::set<std::string> manifests_;
  std::vector<v1::StoredUpload> uploads_;
  // Ids of the operations that have not ended.
  std::set<std::string> live_jobs_;
};

}  // namespace

std::vector<CheckResult> CheckData(FileSystem& files, const std::string& folder,
                                   const DataCheckOptions& options) {
  return DataCheck(files, folder, options).Run();
}

}  // namespace tactus::internal
