#include "server/records/upload_store.h"

#include <algorithm>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/crc32c.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_record.h"
#include "core/store/abandoned_uploads.h"
#include "core/store/lost_and_found.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/request_key.h"
#include "server/records/trial_info.h"
#include "server/records/trial_merge.h"
#include "tactus/v1/trial.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kUploads[] = "uploads";
// Uploads whose drafts are kept between two calls.
constexpr size_t kKeptTakers = 4;
constexpr int64_t kReadBytes = 1024L * 1024;

absl::StatusOr<v1::StoredUpload> FindUpload(const Transaction& look,
                                            const ResourceName& name) {
  TACTUS_ASSIGN_OR_RETURN(
      auto found,
      GetRecord<v1::StoredUpload>(look, Table::kUploads, CatalogKey(name)));
  if (!found.has_value()) {
    return NoSuch(v1::ERROR_REASON_UPLOAD_NOT_FOUND, "upload", name.ToString(),
                  "begin again with trainctl datasets upload");
  }
  return *std::move(found);
}

}  // namespace

absl::StatusOr<v1::StoredUpload> UploadStore::Create(
    absl::string_view dataset, absl::string_view request_id, bool replace,
    const Caller& caller, bool replace_labels) {
  TACTUS_ASSIGN_OR_RETURN(const v1::Dataset target, datasets_->Get(dataset));
  if (const std::string fault = TextFault(request_id, limits::kMaxNameBytes);
      !fault.empty()) {
    return InvalidConfig("request_id", Quoted(request_id), fault);
  }
  TACTUS_RETURN_IF_ERROR(data_->reserve().Check());
  v1::StoredUpload upload;
  TACTUS_RETURN_IF_ERROR(data_->catalog().Change([&](Transaction& change)
                                                     -> absl::Status {
    const std::string request =
        RequestKey(absl::StrCat("upload/", target.name()), caller, request_id);
    if (!request_id.empty()) {
      TACTUS_ASSIGN_OR_RETURN(const auto key,
                              change.Get(Table::kRequests, request));
      if (key.has_value()) {
        TACTUS_ASSIGN_OR_RETURN(auto known, GetRecord<v1::StoredUpload>(
                                                change, Table::kUploads, *key));
        // An abandoned upload was removed; its request is a new one.
        if (known.has_value()) {
          upload = *std::move(known);
          return absl::OkStatus();
        }
      }
    }
    TACTUS_RETURN_IF_ERROR(CheckStoredBytes(change, quotas_, caller.name, 1));
    TACTUS_RETURN_IF_ERROR(CheckUploads(change, quotas_, caller.name));
    TACTUS_ASSIGN_OR_RETURN(const uint64_t number, NextUpload(change));
    upload.set_name(absl::StrCat(kUploads, "/", number));
    upload.set_dataset(target.name());
    upload.set_replace(replace);
    upload.set_replace_labels(replace_labels);
    upload.set_create_time_ms(now_());
    upload.set_requester(caller.name);
    const std::string key = NumberKey(number);
    if (!request_id.empty()) {
      TACTUS_RETURN_IF_ERROR(change.Put(Table::kRequests, request, key));
    }
    TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kUploads, key, upload));
    return Audit(change, caller, now_(), "create", upload.name());
  }));
  return upload;
}

absl::StatusOr<v1::StoredUpload> UploadStore::Get(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kUploads));
  v1::StoredUpload upload;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(upload, FindUpload(look, parsed));
        return absl::OkStatus();
      }));
  return upload;
}

absl::StatusOr<v1::StoredUpload> UploadStore::GetOwn(
    absl::string_view name, const Caller& caller) const {
  TACTUS_ASSIGN_OR_RETURN(v1::StoredUpload upload, Get(name));
  TACTUS_RETURN_IF_ERROR(CheckOwner(caller, upload.name(), upload.requester()));
  return upload;
}

absl::StatusOr<std::unique_ptr<Lock>> UploadStore::Hold(const std::string& id) {
  const std::string name = absl::StrCat(kUploads, "/", id);
  TACTUS_ASSIGN_OR_RETURN(auto lock, data_->locks().TryTake(name));
  if (lock == nullptr) return UploadBusy(name);
  return lock;
}

absl::Status UploadStore::Copy(const Lock& lock, v1::StoredUpload& upload) {
  v1::StoredUpload copy = upload;
  copy.set_copy(upload.copy() + 1);
  const std::string from = data_->UploadPath(UploadFile(upload));
  const std::string to = data_->UploadPath(UploadFile(copy));
  TACTUS_ASSIGN_OR_RETURN(const auto file, data_->files().Append(to));
  // One that was begun before, by a server that died over it.
  TACTUS_RETURN_IF_ERROR(data_->files().Truncate(to, 0));
  for (int64_t done = 0; done < upload.committed_size(); done += kReadBytes) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string bytes,
        data_->files().Read(
            from, done, std::min(kReadBytes, upload.committed_size() - done)));
    TACTUS_RETURN_IF_ERROR(file->Append(bytes));
  }
  TACTUS_RETURN_IF_ERROR(file->Sync());
  TACTUS_RETURN_IF_ERROR(data_->files().SyncDirectory(data_->UploadFolder()));
  TACTUS_RETURN_IF_ERROR(Save(lock, copy));
  upload = copy;
  return data_->files().Remove(from);
}

absl::Status UploadStore::Save(const Lock& lock,
                               const v1::StoredUpload& upload) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(upload.name(), kUploads));
  return data_->catalog().Change([&](Transaction& change) -> absl::Status {
    TACTUS_RETURN_IF_ERROR(lock.StillHeld(change));
    TACTUS_ASSIGN_OR_RETURN(const v1::StoredUpload old,
                            FindUpload(change, name));
    TACTUS_RETURN_IF_ERROR(
        CheckStoredBytes(change, quotas_, upload.requester(),
                         upload.committed_size() - old.committed_size()));
    return PutRecord(change, Table::kUploads, CatalogKey(name), upload);
  });
}

absl::StatusOr<std::unique_ptr<UploadStore::Writer>> UploadStore::Write(
    absl::string_view name, const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kUploads));
  // Before it is held: others must not be able to keep it from its owner.
  TACTUS_RETURN_IF_ERROR(GetOwn(name, caller).status());
  TACTUS_ASSIGN_OR_RETURN(auto lock, Hold(parsed.id));
  // Releases the upload when it is destroyed.
  std::unique_ptr<Writer> writer(new Writer(this, std::move(lock)));
  TACTUS_ASSIGN_OR_RETURN(writer->upload_, Get(name));
  const int64_t committed = writer->upload_.committed_size();
  if (!writer->upload_.dataset_version().empty()) {
    return OffsetMismatch(-1, committed);
  }
  if (writer->lock_->taken_over()) {
    TACTUS_RETURN_IF_ERROR(Copy(*writer->lock_, writer->upload_));
  }
  const std::string path = data_->UploadPath(UploadFile(writer->upload_));
  TACTUS_ASSIGN_OR_RETURN(writer->file_, data_->files().Append(path));
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, data_->files().Size(path));
  if (size < committed) {
    return DataLost(path, absl::StrCat("has ", size, " of ", committed,
                                       " committed bytes"));
  }
  if (size > committed) {
    TACTUS_RETURN_IF_ERROR(data_->files().Truncate(path, committed));
  }
  writer->taker_ = TakeTaker(UploadFile(writer->upload_), committed);
  writer->size_ = committed;
  writer->crc32c_ = writer->upload_.crc32c();
  return writer;
}

UploadStore::Writer::~Writer() {
  if (taker_ != nullptr && taker_->size() == upload_.committed_size()) {
    store_->KeepTaker(UploadFile(upload_), std::move(taker_));
  }
}

absl::Status UploadStore::Writer::Append(int64_t offset,
                                         absl::string_view chunk,
                                         uint32_t crc32c) {
  TACTUS_RETURN_IF_ERROR(fault_);
  if (offset != size_) return OffsetMismatch(offset, size_);
  if (chunk.empty() || chunk.size() > limits::kMaxChunkBytes) {
    return InvalidConfig("size of data", chunk.size(),
                         absl::StrCat("1 to ", limits::kMaxChunkBytes));
  }
  if (const uint32_t got = ExtendCrc32c(0, chunk); got != crc32c) {
    return ChecksumMismatch("data", absl::StrCat(absl::Hex(got)),
                            absl::StrCat(absl::Hex(crc32c)));
  }
  if (size_ + static_cast<int64_t>(chunk.size()) > limits::kMaxUploadBytes) {
    return InvalidConfig("size of the upload", size_ + chunk.size(),
                         absl::StrCat("at most ", limits::kMaxUploadBytes));
  }
  TACTUS_RETURN_IF_ERROR(store_->data_->reserve().Check());
  // A part of the chunk may be written when this fails.
  fault_ = file_->Append(chunk);
  TACTUS_RETURN_IF_ERROR(fault_);
  size_ += static_cast<int64_t>(chunk.size());
  crc32c_ = ExtendCrc32c(crc32c_, chunk);
  // Finish reports what is wrong with a trial.
  if (taker_ != nullptr && !taker_->Add(chunk).ok()) taker_.reset();
  return absl::OkStatus();
}

absl::Status UploadStore::Writer::Commit() {
  if (uncommitted() == 0) return absl::OkStatus();
  TACTUS_RETURN_IF_ERROR(fault_);
  // A second Sync would not report what the first could not write.
  fault_ = file_->Sync();
  TACTUS_RETURN_IF_ERROR(fault_);
  // The taker has them.
  if (taker_ != nullptr) file_->DropCache();
  DataDirectory* data = store_->data_;
  if (upload_.committed_size() == 0) {
    TACTUS_RETURN_IF_ERROR(data->files().SyncDirectory(data->UploadFolder()));
  }
  v1::StoredUpload next = upload_;
  next.set_committed_size(size_);
  next.set_crc32c(crc32c_);
  next.set_write_time_ms(store_->now_());
  if (const absl::Status saved = store_->Save(*lock_, next); !saved.ok()) {
    // What does not count must not use up the disk.
    fault_ = saved;
    data->files()
        .Truncate(data->UploadPath(UploadFile(upload_)),
                  upload_.committed_size())
        .IgnoreError();
    return saved;
  }
  upload_ = next;
  return absl::OkStatus();
}

std::unique_ptr<TrialTaker> UploadStore::NewTaker(const std::string& file,
                                                  MemoryBudget* known) {
  return std::make_unique<TrialTaker>(
      TrialTaker::Sources{.blobs = &data_->blobs(),
                          .parsing = &parsing_,
                          .known = known,
                          .read = [this, path = data_->UploadPath(file)](
                                      int64_t offset, int64_t size) {
                            return data_->files().Read(path, offset, size);
                          }});
}

std::unique_ptr<TrialTaker> UploadStore::TakeTaker(const std::string& file,
                                                   int64_t size) {
  if (size == 0) return NewTaker(file, &known_);
  const std::lock_guard lock(mutex_);
  const auto kept =
      std::find_if(takers_.begin(), takers_.end(),
                   [&](const auto& taker) { return taker.first == file; });
  if (kept == takers_.end()) return nullptr;
  auto taker = std::move(kept->second);
  takers_.erase(kept);
  return taker->size() == size ? std::move(taker) : nullptr;
}

void UploadStore::KeepTaker(const std::string& file,
                            std::unique_ptr<TrialTaker> taker) {
  // Its drafts are removed without the lock.
  std::unique_ptr<TrialTaker> oldest;
  const std::lock_guard lock(mutex_);
  takers_.emplace_back(file, std::move(taker));
  if (takers_.size() > kKeptTakers) {
    oldest = std::move(takers_.front().second);
    takers_.pop_front();
  }
}

absl::StatusOr<std::unique_ptr<TrialTaker>> UploadStore::ReadTrials(
    const std::string& file, int64_t size) {
  // Finish works on one upload after another, so it needs no share of `known_`.
  auto taker = NewTaker(file, nullptr);
  const std::string path = data_->UploadPath(file);
  while (taker->size() < size) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string bytes,
        data_->files().Read(path, taker->size(),
                            std::min(kReadBytes, size - taker->size())));
    TACTUS_RETURN_IF_ERROR(taker->Add(bytes));
  }
  return taker;
}

absl::StatusOr<std::unique_ptr<TrialTaker>> UploadStore::CheckTrials(
    const std::string& file, int64_t size) {
  auto taker = TakeTaker(file, size);
  if (taker != nullptr) {
    // Their blobs may have been deleted since.
    TACTUS_ASSIGN_OR_RETURN(const bool exist, taker->BlobsExist());
    TACTUS_ASSIGN_OR_RETURN(const int64_t stored,
                            data_->files().Size(data_->UploadPath(file)));
    if (!exist || stored < size) taker.reset();
  }
  if (taker == nullptr) {
    TACTUS_ASSIGN_OR_RETURN(taker, ReadTrials(file, size));
  }
  TACTUS_RETURN_IF_ERROR(taker->End());
  return taker;
}

absl::StatusOr<DatasetStore::Content> UploadStore::StoreTrials(
    const v1::StoredUpload& upload, std::vector<v1::TrialInfo> held,
    uint32_t* known, std::vector<v1::TrialNote>* notes) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto taker,
      CheckTrials(UploadFile(upload), upload.committed_size()));
  if (upload.replace()) held.clear();
  datasets_->AddFingerprints(held);
  TACTUS_ASSIGN_OR_RETURN(
      TrialMerge merge,
      MergeTrials(held, taker->trials(),
                  {.replace_labels = upload.replace_labels()}));
  TACTUS_RETURN_IF_ERROR(taker->Commit(known));

  DatasetStore::Content content;
  content.trials = std::move(merge.kept);
  content.about.set_change(v1::DatasetVersion::CHANGE_UPLOAD);
  content.about.set_duplicates(merge.duplicates);
  content.about.set_relabelled(merge.relabelled);
  content.about.set_renamed(static_cast<uint32_t>(merge.new_ids.size()));
  BlobStore::Batch batch = data_->blobs().NewBatch();
  std::set<std::string> used;
  for (const size_t i : merge.added) {
    v1::TrialInfo& trial = content.trials.emplace_back(taker->trials()[i]);
    if (const auto id = merge.new_ids.find(i); id != merge.new_ids.end()) {
      TACTUS_RETURN_IF_ERROR(
          StoreRenamed(data_->blobs(), batch, id->second, trial));
    }
    used.insert(trial.sha256());
  }
  TACTUS_RETURN_IF_ERROR(batch.Commit());
  std::vector<std::string> unused;
  for (const v1::TrialInfo& trial : taker->trials()) {
    if (!used.contains(trial.sha256())) unused.push_back(trial.sha256());
  }
  datasets_->RemoveUnused(unused);
  if (notes != nullptr) *notes = std::move(merge.notes);
  return content;
}

absl::StatusOr<v1::DatasetVersion> UploadStore::Finish(
    absl::string_view name, int64_t size, uint32_t crc32c, const Caller& caller,
    uint32_t* known, std::vector<v1::TrialNote>* notes) {
  *known = 0;
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kUploads));
  TACTUS_RETURN_IF_ERROR(GetOwn(name, caller).status());
  TACTUS_ASSIGN_OR_RETURN(const auto lock, Hold(parsed.id));
  TACTUS_ASSIGN_OR_RETURN(v1::StoredUpload upload, Get(name));
  const std::string path = data_->UploadPath(UploadFile(upload));
  if (!upload.dataset_version().empty()) {
    data_->files().Remove(path).IgnoreError();
    return datasets_->Version(upload.dataset_version());
  }
  if (size != upload.committed_size()) {
    return OffsetMismatch(size, upload.committed_size());
  }
  if (crc32c != upload.crc32c()) {
    return ChecksumMismatch("the upload",
                            absl::StrCat(absl::Hex(upload.crc32c())),
                            absl::StrCat(absl::Hex(crc32c)));
  }
  TACTUS_RETURN_IF_ERROR(data_->reserve().Check());
  TACTUS_ASSIGN_OR_RETURN(
      v1::DatasetVersion version,
      datasets_->AddVersion(
          upload.dataset(),
          [&](std::vector<v1::TrialInfo> held) {
            return StoreTrials(upload, std::move(held), known, notes);
          },
          upload.requester(), caller,
          [&](Transaction& change,
              const v1::DatasetVersion& made) -> absl::Status {
            TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
            upload.set_dataset_version(made.name());
            return PutRecord(change, Table::kUploads, CatalogKey(parsed),
                             upload);
          }));
  // The version exists, whatever becomes of the bytes that it was made of.
  data_->files().Remove(path).IgnoreError();
  return version;
}

absl::StatusOr<int> UploadStore::RemoveAbandoned() {
  const int64_t now = now_();
  std::vector<v1::StoredUpload> abandoned;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(abandoned, AbandonedUploads(look, now));
        return absl::OkStatus();
      }));
  int removed = 0;
  for (const v1::StoredUpload& found : abandoned) {
    // Somebody writes to it again.
    const auto lock = Hold(UploadId(found));
    if (!lock.ok()) continue;
    bool gone = false;
    TACTUS_RETURN_IF_ERROR(data_->reserve().With([&] {
      return data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                                ParseName(found.name(), kUploads));
        TACTUS_ASSIGN_OR_RETURN(const v1::StoredUpload upload,
                                FindUpload(change, name));
        TACTUS_RETURN_IF_ERROR((*lock)->StillHeld(change));
        gone = IsAbandoned(upload, now);
        return gone ? RemoveUpload(change, upload, "tactusd", now)
                    : absl::OkStatus();
      });
    }));
    if (!gone) continue;
    TACTUS_RETURN_IF_ERROR(
        data_->files().Remove(data_->UploadPath(UploadFile(found))));
    ++removed;
  }
  TACTUS_RETURN_IF_ERROR(RemoveStrayFiles());
  return removed;
}

absl::Status UploadStore::RemoveStrayFiles() {
  TACTUS_ASSIGN_OR_RETURN(const auto files,
                          data_->files().List(data_->UploadFolder()));
  uint64_t next = 0;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(next, NextUpload(look));
        return absl::OkStatus();
      }));
  LostAndFound lost(data_->files(), data_->folder());
  for (const std::string& file : files) {
    const std::string id = file.substr(0, file.find('-'));
    // A finished upload's file could not be removed when it was finished, nor
    // one that was copied.
    const auto is_stray = [&] {
      const auto upload = Get(absl::StrCat(kUploads, "/", id));
      return upload.ok() ? !upload->dataset_version().empty() ||
                               UploadFile(*upload) != file
                         : absl::IsNotFound(upload.status());
    };
    if (!is_stray()) continue;
    const auto lock = Hold(id);
    // Somebody may have copied it in between.
    if (!lock.ok() || !is_stray()) continue;
    uint64_t number = 0;
    const bool given = absl::SimpleAtoi(id, &number) && number < next;
    // A number that was never given: the catalogue is an older copy.
    TACTUS_RETURN_IF_ERROR(given
                               ? data_->files().Remove(data_->UploadPath(file))
                               : lost.Take(absl::StrCat(kUploads, "/", file)));
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
