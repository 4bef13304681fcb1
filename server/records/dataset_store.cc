#include "server/records/dataset_store.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_record.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/operation_store.h"
#include "tactus/v1/models.pb.h"
#include "tactus/v1/operations.pb.h"

namespace tactus::internal::server {
namespace {

constexpr char kDatasets[] = "datasets";
// A line for each trial: its SHA-256 in hexadecimal.
constexpr int64_t kMaxManifestBytes = 65L * limits::kMaxTrialsPerVersion;

absl::Status NotFound(absl::string_view name) {
  return NoSuch(v1::ERROR_REASON_DATASET_NOT_FOUND, "dataset", name,
                "trainctl datasets list shows those that do");
}

absl::StatusOr<v1::Dataset> FindDataset(const Transaction& look,
                                        const ResourceName& name) {
  TACTUS_ASSIGN_OR_RETURN(
      auto found, GetRecord<v1::Dataset>(look, Table::kDatasets, name.id));
  if (!found.has_value()) return NotFound(name.Parent());
  return *std::move(found);
}

absl::StatusOr<v1::DatasetVersion> FindVersion(const Transaction& look,
                                               ResourceName name) {
  if (name.version == 0) {
    TACTUS_ASSIGN_OR_RETURN(const v1::Dataset dataset, FindDataset(look, name));
    name.version = dataset.latest_version();
    if (name.version == 0) {
      return NoSuch(v1::ERROR_REASON_DATASET_NOT_FOUND, "dataset version",
                    name.Parent() + "/versions/1",
                    "upload trials with trainctl datasets upload");
    }
  }
  TACTUS_ASSIGN_OR_RETURN(
      auto found, GetRecord<v1::DatasetVersion>(look, Table::kDatasetVersions,
                                                CatalogKey(name)));
  if (!found.has_value()) return NotFound(name.ToString());
  return *std::move(found);
}

// True if `name` is a version of the dataset `parent`, or the dataset.
bool Refers(absl::string_view name, absl::string_view parent) {
  return name == parent || absl::StartsWith(name, absl::StrCat(parent, "/"));
}

// DATASET_IN_USE if something refers to the dataset.
absl::Status CheckUnused(const Transaction& look, const std::string& dataset) {
  TACTUS_ASSIGN_OR_RETURN(
      const auto operations,
      ScanRecords<v1::Operation>(look, Table::kOperations, {}));
  for (const v1::Operation& operation : operations) {
    if (HasEnded(operation)) continue;
    if (Refers(operation.train().dataset_version(), dataset) ||
        Refers(operation.evaluate().dataset_version(), dataset)) {
      return DatasetInUse(dataset, operation.name());
    }
  }
  TACTUS_ASSIGN_OR_RETURN(
      const auto versions,
      ScanRecords<v1::ModelVersion>(look, Table::kModelVersions, {}));
  for (const v1::ModelVersion& version : versions) {
    if (Refers(version.train().dataset_version(), dataset)) {
      return DatasetInUse(dataset, version.name());
    }
  }
  TACTUS_ASSIGN_OR_RETURN(const auto aliases,
                          ScanRecords<v1::Alias>(look, Table::kAliases, {}));
  for (const v1::Alias& alias : aliases) {
    if (Refers(alias.gate().dataset_version(), dataset)) {
      return DatasetInUse(dataset, alias.name());
    }
  }
  return absl::OkStatus();
}

// As the audit log calls what made a version.
const char* VerbOf(const v1::DatasetVersion& version) {
  switch (version.change()) {
    case v1::DatasetVersion::CHANGE_RELABEL:
      return "relabel";
    case v1::DatasetVersion::CHANGE_REMOVE:
      return "remove";
    case v1::DatasetVersion::CHANGE_CONTACTS:
      return "label";
    default:
      return "create";
  }
}

}  // namespace

absl::StatusOr<v1::Dataset> DatasetStore::Create(absl::string_view name,
                                                 absl::string_view description,
                                                 const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kDatasets));
  if (parsed.version != 0) return InvalidName(name, "datasets/ID");
  if (const std::string fault =
          TextFault(description, limits::kMaxDescriptionBytes);
      !fault.empty()) {
    return InvalidConfig("description", Quoted(description), fault);
  }
  v1::Dataset dataset;
  dataset.set_name(parsed.Parent());
  dataset.set_description(std::string(description));
  dataset.set_create_time_ms(now_());
  dataset.set_requester(caller.name);
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto old,
                                change.Get(Table::kDatasets, parsed.id));
        if (old.has_value()) return DatasetExists(dataset.name());
        TACTUS_RETURN_IF_ERROR(CheckDatasets(change, quotas_, caller.name));
        TACTUS_RETURN_IF_ERROR(
            PutRecord(change, Table::kDatasets, parsed.id, dataset));
        return Audit(change, caller, now_(), "create", dataset.name());
      }));
  return dataset;
}

absl::StatusOr<v1::Dataset> DatasetStore::Get(absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kDatasets));
  v1::Dataset dataset;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(dataset, FindDataset(look, parsed));
        return absl::OkStatus();
      }));
  return dataset;
}

absl::StatusOr<Page<v1::Dataset>> DatasetStore::List(
    int page_size, absl::string_view page_token) const {
  Page<v1::Dataset> page;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(
            page.items,
            ScanRecords<v1::Dataset>(
                look, Table::kDatasets,
                {.after = std::string(page_token), .limit = page_size + 1}));
        return absl::OkStatus();
      }));
  if (static_cast<int>(page.items.size()) > page_size) {
    page.items.pop_back();
    page.next_token = page.items.back().name().substr(sizeof kDatasets);
  }
  return page;
}

absl::StatusOr<DatasetStore::History> DatasetStore::GetHistory(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kDatasets));
  History history;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(history.dataset, FindDataset(look, parsed));
        TACTUS_ASSIGN_OR_RETURN(
            history.versions,
            ScanRecords<v1::DatasetVersion>(look, Table::kDatasetVersions,
                                            {.prefix = parsed.id + "/"}));
        return absl::OkStatus();
      }));
  return history;
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::Version(
    absl::string_view name) const {
  v1::DatasetVersion version;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(version, VersionIn(look, name));
        return absl::OkStatus();
      }));
  return version;
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::VersionIn(
    const Transaction& look, absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kDatasets));
  return FindVersion(look, parsed);
}

absl::StatusOr<std::vector<std::string>> DatasetStore::Manifest(
    const v1::DatasetVersion& version) const {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string text,
      data_->blobs().Read(version.sha256(), kMaxManifestBytes));
  return std::vector<std::string>(
      absl::StrSplit(text, '\n', absl::SkipEmpty()));
}

absl::StatusOr<std::vector<v1::TrialInfo>> DatasetStore::Trials(
    const v1::DatasetVersion& version) const {
  TACTUS_ASSIGN_OR_RETURN(const auto manifest, Manifest(version));
  std::vector<v1::TrialInfo> trials;
  trials.reserve(manifest.size());
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        for (const std::string& sha256 : manifest) {
          TACTUS_ASSIGN_OR_RETURN(
              auto trial,
              GetRecord<v1::TrialInfo>(look, Table::kTrials, sha256));
          if (!trial.has_value()) {
            return DataLost(sha256, "the trial is not in the catalogue");
          }
          trials.push_back(*std::move(trial));
        }
        return absl::OkStatus();
      }));
  std::stable_sort(trials.begin(), trials.end(),
                   [](const v1::TrialInfo& a, const v1::TrialInfo& b) {
                     return a.id() < b.id();
                   });
  return trials;
}

absl::StatusOr<uint32_t> DatasetStore::NextVersion(
    const v1::Dataset& dataset) const {
  if (dataset.latest_version() > 0) return dataset.latest_version() + 1;
  uint32_t last = 0;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(last, LastNumber(look, dataset.name()));
        return absl::OkStatus();
      }));
  return last + 1;
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::AddVersion(
    absl::string_view name, MakeContent make, absl::string_view requester,
    const Caller& caller, Join also) {
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  return AddLocked(*lock, name, make, requester, caller, also);
}

absl::StatusOr<v1::DatasetVersion> DatasetStore::AddLocked(
    const Lock& lock, absl::string_view name, MakeContent make,
    absl::string_view requester, const Caller& caller, Join also) {
  TACTUS_ASSIGN_OR_RETURN(v1::Dataset dataset, Get(name));
  std::vector<v1::TrialInfo> held;
  if (dataset.latest_version() > 0) {
    TACTUS_ASSIGN_OR_RETURN(const auto latest, Version(dataset.name()));
    TACTUS_ASSIGN_OR_RETURN(held, Trials(latest));
  }
  // Whether the catalogue knows the fingerprint of each.
  std::map<std::string, bool> before;
  for (const v1::TrialInfo& trial : held) {
    before[trial.sha256()] = !trial.frames_sha256().empty();
  }
  TACTUS_ASSIGN_OR_RETURN(Content content, make(std::move(held)));
  std::map<std::string, v1::TrialInfo> trials;
  for (v1::TrialInfo& trial : content.trials) {
    std::string sha256 = trial.sha256();
    trials[std::move(sha256)] = std::move(trial);
  }

  // A version that cannot be read would be kept for good.
  if (trials.size() > max_trials_) {
    return InvalidTrial(
        absl::StrCat("the new version of ", dataset.name(), " would have ",
                     trials.size(), " trials; it may have at most ",
                     max_trials_, ": divide them among several datasets"));
  }

  v1::DatasetVersion version = std::move(content.about);
  TACTUS_ASSIGN_OR_RETURN(const uint32_t number, NextVersion(dataset));
  version.set_name(absl::StrCat(dataset.name(), "/versions/", number));
  version.set_create_time_ms(now_());
  version.set_trials(static_cast<uint32_t>(trials.size()));
  std::string manifest;
  uint32_t kept = 0;
  int64_t bytes = 0;
  int64_t added_bytes = 0;
  for (const auto& [sha256, trial] : trials) {
    absl::StrAppend(&manifest, sha256, "\n");
    bytes += trial.bytes();
    const bool known = before.contains(sha256);
    kept += known ? 1 : 0;
    added_bytes += known ? 0 : trial.bytes();
    ++(*version.mutable_labels())[trial.label()];
  }
  version.set_bytes(bytes);
  version.set_added_bytes(added_bytes);
  version.set_requester(std::string(requester));
  version.set_added(version.trials() - kept);
  version.set_removed(static_cast<uint32_t>(before.size()) - kept);
  BlobStore::Batch batch = data_->blobs().NewBatch();
  TACTUS_ASSIGN_OR_RETURN(*version.mutable_sha256(), batch.Add(manifest));
  TACTUS_RETURN_IF_ERROR(batch.Commit());

  dataset.set_latest_version(number);
  TACTUS_ASSIGN_OR_RETURN(const ResourceName key,
                          ParseVersionName(version.name(), kDatasets));
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(lock.StillHeld(change));
        for (const auto& [sha256, trial] : trials) {
          const auto known = before.find(sha256);
          if (known != before.end() &&
              (known->second || trial.frames_sha256().empty())) {
            continue;
          }
          TACTUS_RETURN_IF_ERROR(
              PutRecord(change, Table::kTrials, sha256, trial));
        }
        TACTUS_RETURN_IF_ERROR(also(change, version));
        TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kDatasetVersions,
                                         CatalogKey(key), version));
        TACTUS_RETURN_IF_ERROR(
            PutRecord(change, Table::kDatasets, key.id, dataset));
        return Audit(change, caller, now_(), VerbOf(version), version.name(),
                     version.reason());
      }));
  return version;
}

void DatasetStore::AddFingerprints(std::vector<v1::TrialInfo>& trials) const {
  for (v1::TrialInfo& info : trials) {
    if (!info.frames_sha256().empty()) continue;
    const auto bytes =
        data_->blobs().Read(info.sha256(), limits::kMaxTrialRecordBytes);
    if (!bytes.ok()) continue;
    const auto record = StoredTrialRecord(*bytes, info.sha256());
    if (!record.ok()) continue;
    if (const auto trial = FromRecord(*record); trial.ok()) {
      info.set_frames_sha256(FrameFingerprint(*trial));
    }
  }
}

void DatasetStore::RemoveUnused(const std::vector<std::string>& blobs) const {
  std::vector<std::string> unused;
  const absl::Status looked =
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        for (const std::string& sha256 : blobs) {
          TACTUS_ASSIGN_OR_RETURN(const auto found,
                                  look.Get(Table::kTrials, sha256));
          if (!found.has_value()) unused.push_back(sha256);
        }
        return absl::OkStatus();
      });
  if (!looked.ok()) return;
  // A blob that stays behind costs room, nothing else.
  for (const std::string& sha256 : unused) {
    data_->blobs().Remove(sha256).IgnoreError();
  }
}

absl::StatusOr<bool> DatasetStore::IsUsed(const std::string& blob) const {
  bool used = false;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto trial,
                                look.Get(Table::kTrials, blob));
        used = trial.has_value();
        TACTUS_ASSIGN_OR_RETURN(
            const auto datasets,
            ScanRecords<v1::DatasetVersion>(look, Table::kDatasetVersions, {}));
        for (const v1::DatasetVersion& version : datasets) {
          used |= version.sha256() == blob;
        }
        TACTUS_ASSIGN_OR_RETURN(
            const auto models,
            ScanRecords<v1::ModelVersion>(look, Table::kModelVersions, {}));
        for (const v1::ModelVersion& version : models) {
          used |= version.blob_sha256() == blob;
        }
        return absl::OkStatus();
      }));
  return used;
}

absl::StatusOr<uint32_t> DatasetStore::Delete(absl::string_view name,
                                              const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kDatasets));
  if (parsed.version != 0) return InvalidName(name, "datasets/ID");
  TACTUS_ASSIGN_OR_RETURN(const History history, GetHistory(name));
  const std::vector<v1::DatasetVersion>& versions = history.versions;
  std::set<std::string> unused;
  std::set<std::string> manifests;
  for (const v1::DatasetVersion& version : versions) {
    manifests.insert(version.sha256());
    const auto manifest = Manifest(version);
    // A damaged version can be deleted; its trials stay as they are.
    if (absl::IsDataLoss(manifest.status())) continue;
    TACTUS_RETURN_IF_ERROR(manifest.status());
    unused.insert(manifest->begin(), manifest->end());
  }
  std::vector<v1::DatasetVersion> all;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(all, ScanRecords<v1::DatasetVersion>(
                                         look, Table::kDatasetVersions, {}));
        return absl::OkStatus();
      }));
  bool unknown = false;
  for (const v1::DatasetVersion& other : all) {
    if (Refers(other.name(), parsed.Parent())) continue;
    manifests.erase(other.sha256());
    const auto manifest = Manifest(other);
    unknown |= absl::IsDataLoss(manifest.status());
    if (unknown) continue;
    TACTUS_RETURN_IF_ERROR(manifest.status());
    for (const std::string& sha256 : *manifest) unused.erase(sha256);
  }
  // Any trial may belong to a version whose manifest is damaged.
  if (unknown) unused.clear();
  // A full disk must not prevent what makes room.
  TACTUS_RETURN_IF_ERROR(data_->reserve().With([&]() -> absl::Status {
    TACTUS_RETURN_IF_ERROR(data_->catalog().Change([&](Transaction& change)
                                                       -> absl::Status {
      TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
      TACTUS_RETURN_IF_ERROR(CheckUnused(change, parsed.Parent()));
      for (const v1::DatasetVersion& version : versions) {
        TACTUS_ASSIGN_OR_RETURN(const ResourceName key,
                                ParseVersionName(version.name(), kDatasets));
        TACTUS_RETURN_IF_ERROR(
            change.Erase(Table::kDatasetVersions, CatalogKey(key)));
      }
      for (const std::string& sha256 : unused) {
        TACTUS_RETURN_IF_ERROR(change.Erase(Table::kTrials, sha256));
      }
      TACTUS_RETURN_IF_ERROR(change.Erase(Table::kDatasets, parsed.id));
      if (!versions.empty()) {
        TACTUS_ASSIGN_OR_RETURN(const ResourceName last,
                                ParseName(versions.back().name(), kDatasets));
        TACTUS_RETURN_IF_ERROR(change.Put(Table::kNumbers, parsed.Parent(),
                                          NumberKey(last.version)));
      }
      return Audit(change, caller, now_(), "delete", parsed.Parent());
    }));
    // A blob that stays behind costs room, nothing else: the dataset is
    // deleted.
    for (const std::string& sha256 : unused) {
      data_->blobs().Remove(sha256).IgnoreError();
    }
    for (const std::string& sha256 : manifests) {
      data_->blobs().Remove(sha256).IgnoreError();
    }
    return absl::OkStatus();
  }));
  return static_cast<uint32_t>(unused.size());
}

}  // namespace tactus::internal::server
