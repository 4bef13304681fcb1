#include "server/records/pinned_version.h"

#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "server/records/blob_parts.h"

namespace tactus::internal::server {

absl::StatusOr<PinnedVersion> PinnedVersion::Find(const DataDirectory& data,
                                                  const DatasetStore& datasets,
                                                  absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(v1::DatasetVersion info, datasets.Version(name));
  return PinnedVersion(data, datasets, std::move(info));
}

absl::StatusOr<std::vector<v1::TrialInfo>> PinnedVersion::Trials() const {
  auto trials = datasets_->Trials(info_);
  if (!trials.ok()) return Explain(trials.status());
  return trials;
}

absl::Status PinnedVersion::ReadRecord(
    absl::string_view sha256,
    absl::FunctionRef<absl::Status(absl::string_view)> take) const {
  return Explain(
      ReadBlobParts(*data_, sha256, limits::kMaxTrialRecordBytes, take));
}

absl::Status PinnedVersion::Explain(const absl::Status& error) const {
  if (!absl::IsDataLoss(error)) return error;
  // A deletion erases the records before it removes the blobs.
  const absl::Status found = datasets_->Version(info_.name()).status();
  return absl::IsNotFound(found) ? found : error;
}

}  // namespace tactus::internal::server
