// File: dataset_store.h
//
// DatasetStore: named sets of trials with immutable versions.
//
//   DatasetStore datasets(data, now);
//   auto dataset = datasets.Create("datasets/grasps", "", caller);
//   auto version = datasets.Version("datasets/grasps");
//
// A version is a manifest: the sorted SHA-256 of its trials, one per line. The
// manifest is a blob, and its SHA-256 is that of the version.
//
// Errors: INVALID_NAME, DATASET_NOT_FOUND, and those of storage. Thread-safe.
// `data` must outlive it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"
#include "server/records/caller.h"
#include "server/records/paging.h"
#include "server/records/quotas.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

class DatasetStore {
 public:
  // A version has at most `max_trials` trials.
  DatasetStore(DataDirectory* data, NowMs now, const Quotas& quotas = {},
               size_t max_trials = limits::kMaxTrialsPerVersion)
      : data_(data),
        now_(std::move(now)),
        quotas_(quotas),
        max_trials_(max_trials) {}

  // DATASET_EXISTS, QUOTA_EXCEEDED.
  absl::StatusOr<v1::Dataset> Create(absl::string_view name,
                                     absl::string_view description,
                                     const Caller& caller);
  absl::StatusOr<v1::Dataset> Get(absl::string_view name) const;
  // A dataset and all its versions at one moment, the oldest first.
  struct History {
    v1::Dataset dataset;
    std::vector<v1::DatasetVersion> versions;
  };
  absl::StatusOr<History> GetHistory(absl::string_view name) const;
  absl::StatusOr<Page<v1::Dataset>> List(int page_size,
                                         absl::string_view page_token) const;
  // "datasets/D/versions/V", or "datasets/D" for the newest version.
  absl::StatusOr<v1::DatasetVersion> Version(absl::string_view name) const;
  // The same in a transaction of the caller.
  static absl::StatusOr<v1::DatasetVersion> VersionIn(const Transaction& look,
                                                      absl::string_view name);
  // The SHA-256 of the trials of a version, sorted.
  absl::StatusOr<std::vector<std::string>> Manifest(
      const v1::DatasetVersion& version) const;
  // The trials of a version, by id and then by SHA-256.
  absl::StatusOr<std::vector<v1::TrialInfo>> Trials(
      const v1::DatasetVersion& version) const;

  // What a new version holds. Its trials are blobs.
  struct Content {
    std::vector<v1::TrialInfo> trials;
    // How the version came about: `change`, `reason` and the counts that do not
    // follow from the trials.
    v1::DatasetVersion about;
  };
  // Makes the content of a new version from the trials of the newest one.
  using MakeContent = absl::FunctionRef<absl::StatusOr<Content>(
      std::vector<v1::TrialInfo> held)>;
  using Join =
      absl::FunctionRef<absl::Status(Transaction&, const v1::DatasetVersion&)>;

  // Makes a new version. Its added bytes count towards the quota of
  // `requester`. `also` joins the transaction, before the version is in it. No
  // blob is removed in the meantime.
  absl::StatusOr<v1::DatasetVersion> AddVersion(absl::string_view name,
                                                MakeContent make,
                                                absl::string_view requester,
                                                const Caller& caller,
                                                Join also);

  // Make a new version without some trials, or with another label of some, as
  // proto/tactus/v1/training.proto says.
  absl::StatusOr<v1::DatasetVersion> Relabel(
      const v1::RelabelTrialsRequest& request, const Caller& caller);
  absl::StatusOr<v1::DatasetVersion> Remove(
      const v1::RemoveTrialsRequest& request, const Caller& caller);

  // Trials that a server makes.
  struct NewTrials {
    std::string dataset;
    size_t count = 0;
    // Makes one of them, from 0 to `count`; called for each in turn.
    std::function<absl::StatusOr<v1::TrialRecord>(size_t index)> make = {};
    std::string reason;
    std::string request_id;
  };
  // Makes a new version with these trials; one with the frames of a trial that
  // is held takes its place. The same version for a repeated request. The
  // errors of `make`, INVALID_TRIAL for another skin than the dataset's
  // (dataset_skin.h), QUOTA_EXCEEDED.
  absl::StatusOr<v1::DatasetVersion> Take(const NewTrials& trials,
                                          const Caller& caller);

  // Sets the fingerprints that are missing, from the blobs. Trials whose blobs
  // are damaged keep none.
  void AddFingerprints(std::vector<v1::TrialInfo>& trials) const;
  // Removes those of the blobs that are no trial of any version. Only for
  // callers within AddVersion, which holds the lock.
  void RemoveUnused(const std::vector<std::string>& blobs) const;
  // True if a trial, a dataset version or a model version is stored in it.
  absl::StatusOr<bool> IsUsed(const std::string& blob) const;

  // Deletes a dataset, its versions, and the blobs that no other version
  // holds. Returns the number of trials that were removed. DATASET_IN_USE if a
  // job that has not ended, a model version or a gate refers to it.
  absl::StatusOr<uint32_t> Delete(absl::string_view name, const Caller& caller);

 private:
  struct Edit;

  // The lock that is held while versions are made or deleted: blobs that are
  // about to be used must not be removed.
  static constexpr char kChanges[] = "datasets";

  // Makes a new version by an edit; the same one for a repeated request.
  absl::StatusOr<v1::DatasetVersion> Apply(const Edit& edit,
                                           const Caller& caller);
  // The content of the edited version.
  absl::StatusOr<Content> Edited(const Edit& edit, const Caller& caller,
                                 std::vector<v1::TrialInfo> held) const;
  // The content of the version with new trials.
  absl::StatusOr<Content> Merged(const NewTrials& trials, const Caller& caller,
                                 std::vector<v1::TrialInfo> held) const;
  // A copy of the trial's blob with the label that `caller` gave.
  absl::Status StoreRelabelled(BlobStore::Batch& batch,
                               const std::string& label, const Caller& caller,
                               v1::TrialInfo& trial) const;
  // AddVersion with the lock.
  absl::StatusOr<v1::DatasetVersion> AddLocked(const Lock& lock,
                                               absl::string_view name,
                                               MakeContent make,
                                               absl::string_view requester,
                                               const Caller& caller, Join also);
  // The number of the next version, behind those that a deleted dataset of this
  // name had.
  absl::StatusOr<uint32_t> NextVersion(const v1::Dataset& dataset) const;

  DataDirectory* const data_;
  const NowMs now_;
  const Quotas quotas_;
  const size_t max_trials_;
};

}  // namespace tactus::internal::server
