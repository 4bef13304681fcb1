#include "server/records/trial_info.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/serialize.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_record.h"

namespace tactus::internal::server {

v1::TrialInfo InfoOf(const v1::TrialRecord& record, const Trial& trial,
                     const std::string& sha256, size_t bytes) {
  v1::TrialInfo info;
  info.set_sha256(sha256);
  info.set_bytes(static_cast<int64_t>(bytes));
  info.set_id(record.id());
  info.set_label(record.label());
  info.set_condition(record.condition());
  info.set_object(record.object());
  info.set_material(record.material());
  info.set_layout(record.geometry().layout());
  info.set_frames(static_cast<uint32_t>(record.time_size()));
  info.set_source(record.source());
  info.set_frames_sha256(FrameFingerprint(trial));
  if (record.has_labelling()) *info.mutable_labelling() = record.labelling();
  return info;
}

absl::Status StoreRenamed(BlobStore& blobs, BlobStore::Batch& batch,
                          const std::string& id, v1::TrialInfo& trial) {
  TACTUS_ASSIGN_OR_RETURN(
      const std::string bytes,
      blobs.Read(trial.sha256(), limits::kMaxTrialRecordBytes));
  TACTUS_ASSIGN_OR_RETURN(v1::TrialRecord record,
                          StoredTrialRecord(bytes, trial.sha256()));
  record.set_id(id);
  const std::string renamed = SerializeDeterministic(record);
  if (renamed.size() > limits::kMaxTrialRecordBytes) {
    return InvalidTrial(
        absl::StrCat("trial ", Quoted(trial.id()),
                     ": id: names another recording of the "
                     "dataset, and there is no room for a longer one"));
  }
  TACTUS_ASSIGN_OR_RETURN(*trial.mutable_sha256(), batch.Add(renamed));
  trial.set_bytes(static_cast<int64_t>(renamed.size()));
  trial.set_id(id);
  return absl::OkStatus();
}

}  // namespace tactus::internal::server
