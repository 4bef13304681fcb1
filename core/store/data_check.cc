#include "core/store/data_check.h"

#include <algorithm>
#include <map>
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
#include "core/store/copy_mark.h"
#include "core/store/directory_identity.h"
#include "core/store/directory_lock.h"
#include "core/store/disk_use.h"
#include "core/store/lost_and_found.h"
#include "core/store/named_data.h"
#include "core/store/sqlite_catalog.h"
#include "core/store/tables.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal {
namespace {

using Severity = CheckResult::Severity;

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
            const SharedCatalog* shared, const DataCheckOptions& options)
      : files_(files),
        folder_(folder),
        shared_(shared),
        options_(options),
        lost_(files, folder) {}

  std::vector<CheckResult> Run() {
    CheckFreeBytes();
    if (shared_ != nullptr ? TakeShared()
                           : Lock() && (!options_.accept_catalog || Accept()) &&
                                 OpenCatalog()) {
      ReadRecords();
      CheckBlobs();
      // What servers make at this moment is named a moment later.
      if (at_work_) return std::move(results_);
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

  // Reads a catalogue that servers share, with its folder.
  bool TakeShared() {
    if (shared_->servers.empty()) {
      Add("lock", Severity::kOk, "no server uses the catalogue");
    } else {
      at_work_ = true;
      Add("lock", Severity::kWarning,
          absl::StrCat("servers are at work: ", NamesOf(shared_->servers)),
          "stop them to check what nothing names, too");
    }
    catalog_ = shared_->catalog;
    absl::Status status = RefuseUnfinishedCopy(*catalog_, shared_->address);
    if (!status.ok()) return Refuse(status);
    const auto used = DirectoryWasUsed(files_, folder_);
    if (!used.ok()) return Refuse(used.status());
    status = CheckCatalogBelongs(files_, folder_, *catalog_);
    if (absl::IsDataLoss(status) || !*used) {
      status = DataLost(folder_,
                        "it is not the folder of this catalogue; give the one "
                        "that the servers of the catalogue have as --blobs");
    }
    if (!status.ok()) return Refuse(status);
    return CheckAge(absl::StrCat(shared_->address, " belongs to ", folder_));
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
    own_catalog_ = *std::move(catalog);
    catalog_ = own_catalog_.get();
    status = RefuseUnfinishedCopy(*catalog_, folder_);
    if (status.ok()) status = CheckCatalogBelongs(files_, folder_, *catalog_);
    if (!status.ok()) return Refuse(status);
    return CheckAge(absl::StrCat("version ", *version,
                                 ", its structure is intact, and its records "
                                 "are those that the server wrote"));
  }

  // `good`: what to say if the catalogue is not older than the folder.
  bool CheckAge(std::string good) {
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
    Add("catalogue", Severity::kOk, std::move(good));
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
    named_ = {};
    for (const auto& [table, name] : kTables) {
      const absl::Status status = VisitEntries(
          *catalog_, table,
          [&, table = table](const CatalogEntry& entry) -> absl::Status {
            ++records;
            return named_.Take(table, entry);
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

  std::string PathOfBlob(const std::string& sha256) const {
    return BlobPath(absl::StrCat(folder_, "/blobs"), sha256);
  }

  // What is wrong with a blob; empty if nothing is. `trials` receives those
  // that a manifest lists.
  std::string FaultOfBlob(const std::string& sha256,
                          std::set<std::string>* trials) {
    const std::string path = PathOfBlob(sha256);
    const auto size = files_.Size(path);
    if (!size.ok() || *size < 0) return sha256 + " is missing";
    const auto bytes = ReadBlobFile(files_, path, sha256, *size);
    if (!bytes.ok()) return sha256 + " is damaged";
    if (!named_.manifests.contains(sha256)) return "";
    for (const auto line : absl::StrSplit(*bytes, '\n', absl::SkipEmpty())) {
      trials->insert(std::string(line));
    }
    return "";
  }

  // What is wrong, by blob.
  std::map<std::string, std::string> BadBlobs() {
    std::map<std::string, std::string> bad;
    // Manifests name trials, which the catalogue names too.
    std::set<std::string> trials;
    for (const std::string& sha256 : named_.blobs) {
      std::string fault = FaultOfBlob(sha256, &trials);
      if (!fault.empty()) bad[sha256] = std::move(fault);
    }
    if (complete_) {
      for (const std::string& trial : trials) {
        if (named_.blobs.contains(trial)) continue;
        bad[trial] = absl::StrCat("trial ", trial, " has no record");
      }
    }
    return bad;
  }

  void CheckBlobs() {
    std::map<std::string, std::string> found = BadBlobs();
    if (at_work_ && !found.empty()) {
      // A server may have deleted a dataset meanwhile.
      ReadRecordsAgain();
      const std::map<std::string, std::string> again = BadBlobs();
      std::erase_if(
          found, [&](const auto& blob) { return !again.contains(blob.first); });
    }
    std::vector<std::string> bad;
    for (auto& [sha256, fault] : found) bad.push_back(std::move(fault));
    const size_t all = named_.blobs.size();
    if (bad.empty()) {
      Add("blobs", Severity::kOk,
          absl::StrCat(all, " blobs have their SHA-256"));
    } else {
      Add("blobs", Severity::kError,
          absl::StrCat(bad.size(), " of ", all, ": ", NamesOf(bad)),
          "restore these files from a back-up, or delete what names them");
    }
  }

  void ReadRecordsAgain() {
    named_ = {};
    for (const auto& named : kTables) {
      const Table table = named.first;
      // The first reading has said what is wrong.
      VisitEntries(*catalog_, table, [&](const CatalogEntry& entry) {
        return named_.Take(table, entry);
      }).IgnoreError();
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
      // Servers delete what is there, or put it back.
      if (shared_ != nullptr && shelf == "removed") continue;
      const bool drafts = shelf == "drafts";
      for (const std::string& name : List("blobs/" + shelf)) {
        if (!drafts && (!IsSha256Hex(name) || named_.blobs.contains(name))) {
          continue;
        }
        const std::string path = absl::StrCat("blobs/", shelf, "/", name);
        // Each server that shares the folder has one for its drafts.
        if (shared_ != nullptr && drafts && List(path).empty()) continue;
        orphans.push_back(path);
        bytes += BytesOf(absl::StrCat(folder_, "/", path));
      }
    }
    Report("orphans", "blobs that nothing names", orphans, bytes);
  }

  void CheckUploads() {
    std::set<std::string> live;
    std::vector<std::string> short_ones;
    std::vector<v1::StoredUpload> abandoned;
    std::vector<std::string> stray;
    for (const v1::StoredUpload& upload : named_.uploads) {
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
      if (named_.live_jobs.contains(id)) continue;
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
  // Null for a data directory.
  const SharedCatalog* const shared_;
  const DataCheckOptions& options_;
  LostAndFound lost_;
  std::vector<CheckResult> results_;
  std::unique_ptr<DirectoryLock> lock_;
  std::unique_ptr<Catalog> own_catalog_;
  Catalog* catalog_ = nullptr;
  // Servers use the catalogue at the same time.
  bool at_work_ = false;
  // Every record could be read.
  bool complete_ = true;
  NamedData named_;
};

}  // namespace

std::vector<CheckResult> CheckData(FileSystem& files, const std::string& folder,
                                   const DataCheckOptions& options) {
  return DataCheck(files, folder, nullptr, options).Run();
}

std::vector<CheckResult> CheckSharedData(FileSystem& files,
                                         const std::string& folder,
                                         const SharedCatalog& shared,
                                         const DataCheckOptions& options) {
  return DataCheck(files, folder, &shared, options).Run();
}

}  // namespace tactus::internal
