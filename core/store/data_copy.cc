#include "core/store/data_copy.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/store/abandoned_uploads.h"
#include "core/store/blob_store.h"
#include "core/store/copy_mark.h"
#include "core/store/copy_records.h"
#include "core/store/directory_identity.h"
#include "core/store/named_data.h"
#include "core/store/tables.h"

namespace tactus::internal {
namespace {

// In the folder of drafts that servers share.
constexpr char kDraftsOfCopy[] = "copy";
// Blobs that become durable together.
constexpr size_t kBlobsPerCommit = 512;
constexpr int64_t kBytesPerCommit = 64L * 1024 * 1024;
constexpr int64_t kCopyBytes = 1024L * 1024;
constexpr int64_t kMaxNoteBytes = 100;

class DataCopy {
 public:
  DataCopy(FileSystem& files, const CopyPlace& from, const CopyPlace& to,
           const Progress& progress)
      : files_(files), from_(from), to_(to), progress_(progress) {}

  absl::StatusOr<CopyReport> Run() {
    TACTUS_RETURN_IF_ERROR(CheckServers(from_));
    TACTUS_RETURN_IF_ERROR(CheckServers(to_));
    TACTUS_RETURN_IF_ERROR(CheckSource());
    TACTUS_RETURN_IF_ERROR(Begin());
    TACTUS_RETURN_IF_ERROR(CopyBlobs());
    TACTUS_RETURN_IF_ERROR(CopyUploads());
    TACTUS_RETURN_IF_ERROR(CopyJobs());
    TACTUS_RETURN_IF_ERROR(CopyAllRecords());
    TACTUS_RETURN_IF_ERROR(CheckTarget());
    TACTUS_RETURN_IF_ERROR(CheckServers(from_));
    TACTUS_RETURN_IF_ERROR(CheckServers(to_));
    TACTUS_RETURN_IF_ERROR(End());
    return report_;
  }

 private:
  static absl::Status CheckServers(const CopyPlace& place) {
    if (!place.servers) return absl::OkStatus();
    TACTUS_ASSIGN_OR_RETURN(const std::vector<std::string> servers,
                            place.servers());
    if (servers.empty()) return absl::OkStatus();
    return IoError(place.folder,
                   absl::StrCat("servers are at work on its catalogue: ",
                                NameSome(servers), ". Stop them first"));
  }

  absl::Status CheckSource() {
    TACTUS_RETURN_IF_ERROR(from_.catalog->Check());
    TACTUS_RETURN_IF_ERROR(RefuseUnfinishedCopy(*from_.catalog, from_.folder));
    TACTUS_RETURN_IF_ERROR(
        CheckCatalogBelongs(files_, from_.folder, *from_.catalog));
    TACTUS_ASSIGN_OR_RETURN(mark_.source, DirectoryIdOf(*from_.catalog));
    if (mark_.source.empty()) {
      return IoError(from_.folder,
                     "no server has used it. There is nothing to copy");
    }
    // Before they are read for what they name: what changes later is seen.
    TACTUS_ASSIGN_OR_RETURN(source_, DigestRecords(*from_.catalog));
    for (const auto& named : kTables) {
      const Table table = named.first;
      TACTUS_RETURN_IF_ERROR(
          VisitEntries(*from_.catalog, table, [&](const CatalogEntry& entry) {
            return named_.Take(table, entry);
          }));
    }
    std::vector<std::string> missing;
    for (const std::string& sha256 : named_.blobs) {
      TACTUS_ASSIGN_OR_RETURN(const int64_t size,
                              files_.Size(BlobOf(from_, sha256)));
      if (size < 0) {
        missing.push_back(sha256);
      } else {
        report_.blob_bytes += size;
      }
    }
    if (!missing.empty()) return BadBlobs("are missing", missing);
    report_.blobs = static_cast<int64_t>(named_.blobs.size());
    return CountUnnamed();
  }

  absl::Status CountUnnamed() {
    const std::string folder = from_.folder + "/blobs";
    TACTUS_ASSIGN_OR_RETURN(const auto shelves, FilesOf(from_, "/blobs"));
    for (const std::string& shelf : shelves) {
      if (shelf == "drafts" || shelf == "removed") continue;
      TACTUS_ASSIGN_OR_RETURN(const auto names,
                              files_.List(absl::StrCat(folder, "/", shelf)));
      report_.unnamed_blobs +=
          std::ranges::count_if(names, [&](const std::string& name) {
            return IsSha256Hex(name) && !named_.blobs.contains(name);
          });
    }
    return absl::OkStatus();
  }

  absl::Status BadBlobs(absl::string_view what,
                        const std::vector<std::string>& blobs) const {
    return DataLost(
        from_.folder + "/blobs",
        absl::StrCat(blobs.size(), " of ", named_.blobs.size(), " blobs ", what,
                     ": ", NameSome(blobs),
                     ". Restore these files from a back-up, or start the "
                     "server and delete the datasets or models that need them. "
                     "trainctl doctor finds all. Then run the copy again"));
  }

  static std::string BlobOf(const CopyPlace& place, const std::string& sha256) {
    return BlobPath(place.folder + "/blobs", sha256);
  }
  std::string NotePath() const { return to_.folder + "/copying"; }

  absl::Status NotEmpty(absl::string_view what) const {
    return IoError(to_.folder,
                   absl::StrCat("the target is not empty: ", what,
                                ". Give an empty database and an empty folder, "
                                "or those of the same copy that was begun"));
  }

  // Takes the target: from now on no server starts with it.
  absl::Status Begin() {
    TACTUS_ASSIGN_OR_RETURN(mark_.run, NewId());
    std::optional<CopyMark> found;
    std::string copied_from;
    TACTUS_RETURN_IF_ERROR(
        to_.catalog->Look([&](const Transaction& look) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(found, ReadCopyMark(look));
          TACTUS_ASSIGN_OR_RETURN(copied_from, CopiedFrom(look));
          return absl::OkStatus();
        }));
    if (found.has_value() && found->source != mark_.source) {
      return NotEmpty("a copy of other data was begun there");
    }
    report_.resumed = found.has_value();
    if (!found.has_value()) {
      TACTUS_ASSIGN_OR_RETURN(const bool has_records,
                              HasCopiedRecords(*to_.catalog));
      if (has_records && copied_from == mark_.source) {
        return NotEmpty("the copy of this source was finished before");
      }
      if (has_records) return NotEmpty("its catalogue has records");
    }
    TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(to_.folder));
    TACTUS_RETURN_IF_ERROR(CheckFolder());
    TACTUS_RETURN_IF_ERROR(
        to_.catalog->Change([&](Transaction& change) -> absl::Status {
          TACTUS_ASSIGN_OR_RETURN(const auto now, ReadCopyMark(change));
          if (now.has_value() != found.has_value()) {
            return NotEmpty("another copy begins there");
          }
          return PutCopyMark(change, mark_);
        }));
    TACTUS_RETURN_IF_ERROR(WriteAtomically(files_, NotePath(), mark_.source));
    for (const char* part : {"/blobs", "/uploads", "/jobs"}) {
      TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(to_.folder + part));
    }
    TACTUS_RETURN_IF_ERROR(files_.SyncDirectory(to_.folder));
    TACTUS_RETURN_IF_ERROR(files_.RemoveAll(DraftFolder()));
    TACTUS_ASSIGN_OR_RETURN(
        blobs_, to_.shared ? BlobStore::OpenShared(
                                 files_, to_.folder + "/blobs", kDraftsOfCopy)
                           : BlobStore::Open(files_, to_.folder + "/blobs"));
    return absl::OkStatus();
  }

  std::string DraftFolder() const {
    return absl::StrCat(to_.folder, "/blobs/drafts/", kDraftsOfCopy);
  }

  // The folder of the target is empty, or of the same copy.
  absl::Status CheckFolder() {
    TACTUS_ASSIGN_OR_RETURN(const int64_t noted, files_.Size(NotePath()));
    if (noted >= 0) {
      TACTUS_ASSIGN_OR_RETURN(const std::string note,
                              ReadWhole(files_, NotePath(), kMaxNoteBytes));
      if (note == mark_.source) return absl::OkStatus();
      return NotEmpty("the folder holds a copy of other data");
    }
    const int data = CountData(files_, to_.folder);
    if (data > 0) {
      return NotEmpty(
          absl::StrCat("the folder holds ", data, " blobs and uploads"));
    }
    // Servers may have run there that stored nothing.
    const absl::Status belongs =
        CheckCatalogBelongs(files_, to_.folder, *to_.catalog);
    if (absl::IsDataLoss(belongs)) {
      return NotEmpty("the folder belongs to another catalogue");
    }
    return belongs;
  }

  absl::Status StillOurs() const {
    return to_.catalog->Look(
        [&](const Transaction& look) { return CheckCopyMark(look, mark_); });
  }

  // Reads each blob, and writes those that the target does not have. Goes on
  // after a damaged one, so that all are named at once.
  absl::Status CopyBlobs() {
    const Progress part = progress_.Part("copying blobs", 1);
    std::vector<std::string> damaged;
    auto next = named_.blobs.begin();
    while (next != named_.blobs.end()) {
      BlobStore::Batch batch = blobs_->NewBatch();
      int64_t bytes = 0;
      for (size_t i = 0; i < kBlobsPerCommit && bytes < kBytesPerCommit &&
                         next != named_.blobs.end();
           ++i, ++next) {
        const std::string path = BlobOf(from_, *next);
        TACTUS_ASSIGN_OR_RETURN(const int64_t size, files_.Size(path));
        const auto blob = ReadBlobFile(files_, path, *next, size);
        if (absl::IsDataLoss(blob.status())) {
          damaged.push_back(*next);
          continue;
        }
        TACTUS_RETURN_IF_ERROR(blob.status());
        TACTUS_RETURN_IF_ERROR(batch.Add(*blob).status());
        bytes += size;
      }
      TACTUS_RETURN_IF_ERROR(StillOurs());
      TACTUS_RETURN_IF_ERROR(batch.Commit());
      part.Add(Share(bytes, report_.blob_bytes));
    }
    if (!damaged.empty()) return BadBlobs("are damaged", damaged);
    // An earlier run left them, if the source has changed since.
    TACTUS_ASSIGN_OR_RETURN(const auto there, blobs_->List());
    for (const std::string& sha256 : there) {
      if (named_.blobs.contains(sha256)) continue;
      TACTUS_RETURN_IF_ERROR(files_.Remove(BlobOf(to_, sha256)));
    }
    return absl::OkStatus();
  }

  static double Share(int64_t part, int64_t all) {
    return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
  }

  // The committed bytes of a file, with their CRC32C.
  absl::StatusOr<uint32_t> ChecksumOf(const std::string& path, int64_t size) {
    uint32_t crc = 0;
    for (int64_t done = 0; done < size; done += kCopyBytes) {
      TACTUS_ASSIGN_OR_RETURN(
          const std::string bytes,
          files_.Read(path, done, std::min(kCopyBytes, size - done)));
      crc = ExtendCrc32c(crc, bytes);
    }
    return crc;
  }

  // The first `size` bytes; `to` appears complete.
  absl::Status CopyFile(const std::string& from, const std::string& to,
                        int64_t size) {
    const std::string draft = to + ".copy";
    TACTUS_RETURN_IF_ERROR(files_.Remove(draft));
    {
      TACTUS_ASSIGN_OR_RETURN(const auto file, files_.Append(draft));
      for (int64_t done = 0; done < size; done += kCopyBytes) {
        TACTUS_ASSIGN_OR_RETURN(
            const std::string bytes,
            files_.Read(from, done, std::min(kCopyBytes, size - done)));
        TACTUS_RETURN_IF_ERROR(file->Append(bytes));
      }
      TACTUS_RETURN_IF_ERROR(file->Sync());
    }
    return files_.Rename(draft, to);
  }

  absl::Status CopyUploads() {
    std::set<std::string> wanted;
    for (const v1::StoredUpload& upload : named_.uploads) {
      // A finished one has no file, and one without bytes need not have it.
      if (!upload.dataset_version().empty() || upload.committed_size() == 0) {
        continue;
      }
      const std::string file = absl::StrCat("/uploads/", UploadFile(upload));
      const std::string source = from_.folder + file;
      const std::string target = to_.folder + file;
      wanted.insert(UploadFile(upload));
      ++report_.uploads;
      const int64_t size = upload.committed_size();
      const auto crc = ChecksumOf(source, size);
      if (absl::IsDataLoss(crc.status()) ||
          (crc.ok() && *crc != upload.crc32c())) {
        return DataLost(
            source,
            absl::StrCat("does not have the ", size,
                         " bytes that were committed of ", upload.name(),
                         ". Restore this file from a back-up, or "
                         "start the server and send them again"));
      }
      TACTUS_RETURN_IF_ERROR(crc.status());
      TACTUS_ASSIGN_OR_RETURN(const int64_t there, files_.Size(target));
      if (there == size) {
        TACTUS_ASSIGN_OR_RETURN(const uint32_t is, ChecksumOf(target, size));
        if (is == upload.crc32c()) continue;
      }
      TACTUS_RETURN_IF_ERROR(StillOurs());
      TACTUS_RETURN_IF_ERROR(CopyFile(source, target, size));
      TACTUS_ASSIGN_OR_RETURN(const uint32_t is, ChecksumOf(target, size));
      if (is != upload.crc32c()) {
        return DataLost(target, "does not have the bytes that were written");
      }
    }
    return RemoveOthers("/uploads", wanted);
  }

  // What an earlier run left, if the source has changed since.
  absl::Status RemoveOthers(const std::string& part,
                            const std::set<std::string>& wanted) {
    TACTUS_ASSIGN_OR_RETURN(const auto names, files_.List(to_.folder + part));
    for (const std::string& name : names) {
      if (wanted.contains(name)) continue;
      TACTUS_RETURN_IF_ERROR(
          files_.RemoveAll(absl::StrCat(to_.folder, part, "/", name)));
    }
    return files_.SyncDirectory(to_.folder + part);
  }

  absl::Status CopyJobs() {
    std::set<std::string> wanted;
    TACTUS_ASSIGN_OR_RETURN(const auto folders, FilesOf(from_, "/jobs"));
    TACTUS_RETURN_IF_ERROR(StillOurs());
    for (const std::string& id : folders) {
      if (!named_.live_jobs.contains(id)) continue;
      wanted.insert(id);
      ++report_.jobs;
      const std::string path = "/jobs/" + id;
      TACTUS_RETURN_IF_ERROR(files_.RemoveAll(to_.folder + path));
      TACTUS_RETURN_IF_ERROR(CopyFolder(path));
    }
    return RemoveOthers("/jobs", wanted);
  }

  // Names in a folder; none if it does not exist.
  absl::StatusOr<std::vector<std::string>> FilesOf(const CopyPlace& place,
                                                   const std::string& path) {
    TACTUS_ASSIGN_OR_RETURN(const int64_t size,
                            files_.Size(place.folder + path));
    if (size < 0) return std::vector<std::string>();
    return files_.List(place.folder + path);
  }

  absl::Status CopyFolder(const std::string& path) {
    TACTUS_RETURN_IF_ERROR(files_.MakeDirectory(to_.folder + path));
    TACTUS_ASSIGN_OR_RETURN(const auto names, files_.List(from_.folder + path));
    for (const std::string& name : names) {
      const std::string inner = absl::StrCat(path, "/", name);
      // A folder can be listed, a file cannot.
      if (files_.List(from_.folder + inner).ok()) {
        TACTUS_RETURN_IF_ERROR(CopyFolder(inner));
        continue;
      }
      TACTUS_ASSIGN_OR_RETURN(const int64_t size,
                              files_.Size(from_.folder + inner));
      // A link that leads nowhere, or a socket.
      if (size < 0) continue;
      TACTUS_RETURN_IF_ERROR(
          CopyFile(from_.folder + inner, to_.folder + inner, size));
    }
    return files_.SyncDirectory(to_.folder + path);
  }

  absl::Status CopyAllRecords() {
    const Progress part = progress_.Part("copying records", 1);
    return CopyRecords(*from_.catalog, *to_.catalog, mark_, [&](int64_t more) {
      part.Add(Share(more, source_.records));
    });
  }

  absl::Status CheckTarget() {
    const Progress part = progress_.Part("checking the copy", 1);
    TACTUS_ASSIGN_OR_RETURN(const RecordsDigest source,
                            DigestRecords(*from_.catalog));
    TACTUS_ASSIGN_OR_RETURN(const RecordsDigest target,
                            DigestRecords(*to_.catalog));
    if (source.sha256 != source_.sha256 || source.sha256 != target.sha256) {
      return IoError(
          to_.folder,
          absl::StrCat("the source has ", source.records,
                       " records with the SHA-256 ", source.sha256,
                       ", and the copy ", target.records, " with ",
                       target.sha256,
                       ". The source was changed meanwhile: stop what uses "
                       "it, and run the copy again"));
    }
    report_.records = source.records;
    report_.records_sha256 = source.sha256;
    for (const std::string& sha256 : named_.blobs) {
      const std::string path = BlobOf(to_, sha256);
      TACTUS_ASSIGN_OR_RETURN(const int64_t size, files_.Size(path));
      TACTUS_RETURN_IF_ERROR(ReadBlobFile(files_, path, sha256, size).status());
      part.Add(Share(size, report_.blob_bytes));
    }
    return absl::OkStatus();
  }

  absl::Status End() {
    TACTUS_RETURN_IF_ERROR(StillOurs());
    TACTUS_RETURN_IF_ERROR(files_.RemoveAll(DraftFolder()));
    TACTUS_RETURN_IF_ERROR(MarkDirectory(files_, to_.folder, *to_.catalog));
    TACTUS_RETURN_IF_ERROR(to_.catalog->Change(
        [&](Transaction& change) { return EndCopy(change, mark_); }));
    // The catalogue says that the copy is finished; the note does not matter.
    files_.Remove(NotePath()).IgnoreError();
    return absl::OkStatus();
  }

  FileSystem& files_;
  const CopyPlace& from_;
  const CopyPlace& to_;
  const Progress& progress_;
  CopyReport report_;
  CopyMark mark_;
  // The source's records at the beginning, and what they name.
  RecordsDigest source_;
  NamedData named_;
  // Those of the target.
  std::unique_ptr<BlobStore> blobs_;
};

}  // namespace

absl::StatusOr<CopyReport> CopyData(FileSystem& files, const CopyPlace& from,
                                    const CopyPlace& to,
                                    const Progress& progress) {
  return DataCopy(files, from, to, progress).Run();
}

}  // namespace tactus::internal
