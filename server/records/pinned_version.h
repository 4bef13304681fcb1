// File: pinned_version.h
//
// PinnedVersion: a dataset version that was found, for work that goes on while
// others may delete it. Who has one needs no second look-up by its name.
//
//   TACTUS_ASSIGN_OR_RETURN(
//       const auto version,
//       PinnedVersion::Find(data, datasets, "datasets/grasps"));
//   operation.mutable_train()->set_dataset_version(version.name());
//   TACTUS_ASSIGN_OR_RETURN(const auto trials, version.Trials());
//
// It does not keep the version's blobs. If they are gone because the version
// was deleted, the error is DATASET_NOT_FOUND and not that of damaged storage.
//
// A value; thread-safe while it is const. The stores must outlive it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"
#include "server/records/dataset_store.h"
#include "tactus/v1/training.pb.h"

namespace tactus::internal::server {

class PinnedVersion {
 public:
  // "datasets/D/versions/V", or "datasets/D" for the newest version.
  // INVALID_NAME, DATASET_NOT_FOUND.
  static absl::StatusOr<PinnedVersion> Find(const DataDirectory& data,
                                            const DatasetStore& datasets,
                                            absl::string_view name);

  // As it was when it was found.
  const v1::DatasetVersion& info() const { return info_; }
  // "datasets/D/versions/V".
  const std::string& name() const { return info_.name(); }

  // By id and then by SHA-256.
  absl::StatusOr<std::vector<v1::TrialInfo>> Trials() const;
  // Runs `take` on the serialized record of the trial with this SHA-256, in
  // parts (blob_parts.h).
  absl::Status ReadRecord(
      absl::string_view sha256,
      absl::FunctionRef<absl::Status(absl::string_view)> take) const;

  // What `error`, which work on the version's trials ended with, means:
  // DATASET_NOT_FOUND if bytes are missing because the version was deleted,
  // else the same error.
  absl::Status Explain(const absl::Status& error) const;

 private:
  PinnedVersion(const DataDirectory& data, const DatasetStore& datasets,
                v1::DatasetVersion info)
      : data_(&data), datasets_(&datasets), info_(std::move(info)) {}

  const DataDirectory* data_;
  const DatasetStore* datasets_;
  v1::DatasetVersion info_;
};

}  // namespace tactus::internal::server
