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
#include <mutex>
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

namespace tactus::server {

class DatasetStore {
 public:
  DatasetStore(DataDirectory* data, NowMs now, const Quotas& quotas = {})
      : data_(data), now_(std::move(now)), quotas_(quotas) {}

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

  // Makes a new version of the trials that `store` makes blobs of, and of those
  // of the newest version unless `replace`. The added bytes count towards the
  // quota of `requester`. `also` joins the transaction. No blob is removed in
  // the meantime.
  absl::StatusOr<v1::DatasetVersion> AddVersion(
      absl::string_view name,
      absl::FunctionRef<absl::StatusOr<std::vector<v1::TrialInfo>>()> store,
      bool replace, absl::string_view requester, const Caller& caller,
      absl::FunctionRef<absl::Status(Transaction&, const v1::DatasetVersion&)>
          also);

  // Deletes a dataset, its versions, and the blobs that no other version
  // holds. Returns the number of trials that were removed. DATASET_IN_USE if a
  // job that has not ended, a model version or a gate refers to it.
  absl::StatusOr<uint32_t> Delete(absl::string_view name, const Caller& caller);

 private:
  // The number of the next version, behind those that a deleted dataset of this
  // name had.
  absl::StatusOr<uint32_t> NextVersion(const v1::Dataset& dataset) const;

  DataDirectory* const data_;
  const NowMs now_;
  const Quotas quotas_;
  // Held while versions are made or deleted: blobs that are about to be used
  // must not be removed.
  std::mutex mutex_;
};

}  // namespace tactus::server
