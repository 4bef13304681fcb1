#include "server/records/trial_taker.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/data/trial_record.h"

namespace tactus::server {
namespace {

constexpr size_t kLengthBytes = 4;

uint32_t LengthOf(absl::string_view pack) {
  uint32_t length = 0;
  std::memcpy(&length, pack.data(), sizeof length);
  return length;
}

v1::TrialInfo InfoOf(const v1::TrialRecord& record, const std::string& sha256,
                     size_t bytes) {
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
  return info;
}

}  // namespace

absl::Status TrialTaker::Add(absl::string_view bytes) {
  if (fault_.ok()) fault_ = Take(bytes);
  if (fault_.ok()) size_ += static_cast<int64_t>(bytes.size());
  return fault_;
}

absl::Status TrialTaker::Take(absl::string_view bytes) {
  while (!bytes.empty()) {
    // Where the record begins: in `partial_` or, whole, in `bytes`.
    const absl::string_view head = partial_.empty() ? bytes : partial_;
    size_t want = kLengthBytes;
    if (head.size() >= kLengthBytes) {
      const uint32_t length = LengthOf(head);
      if (length == 0 || length > limits::kMaxTrialRecordBytes) {
        return InvalidTrial(absl::StrCat(
            "trial number ", trials_.size() + 1, " has ", length,
            " bytes; it must have 1 to ", limits::kMaxTrialRecordBytes));
      }
      want += length;
      if (partial_.empty() && bytes.size() >= want) {
        TACTUS_RETURN_IF_ERROR(
            TakeRecord(bytes.substr(kLengthBytes, want - kLengthBytes)));
        bytes.remove_prefix(want);
        continue;
      }
    }
    const size_t taken = std::min(want - partial_.size(), bytes.size());
    partial_.append(bytes.data(), taken);
    bytes.remove_prefix(taken);
    if (want > kLengthBytes && partial_.size() == want) {
      TACTUS_RETURN_IF_ERROR(
          TakeRecord(absl::string_view(partial_).substr(kLengthBytes)));
      partial_.clear();
    }
  }
  return absl::OkStatus();
}

absl::Status TrialTaker::TakeRecord(absl::string_view bytes) {
  v1::TrialRecord record;
  if (!record.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return InvalidTrial(absl::StrCat("trial number ", trials_.size() + 1,
                                     " is not a tactus.v1.TrialRecord"));
  }
  TACTUS_RETURN_IF_ERROR(FromRecord(record).status());
  TACTUS_ASSIGN_OR_RETURN(const std::string sha256, batch_.Add(bytes));
  trials_.push_back(InfoOf(record, sha256, bytes.size()));
  return absl::OkStatus();
}

absl::Status TrialTaker::End() {
  TACTUS_RETURN_IF_ERROR(fault_);
  if (!partial_.empty()) {
    const std::string end =
        partial_.size() < kLengthBytes
            ? "the pack ends within its length"
            : absl::StrCat("it has ", LengthOf(partial_),
                           " bytes, but the pack ends before");
    return InvalidTrial(absl::StrCat("trial number ", trials_.size() + 1,
                                     " is cut short: ", end));
  }
  if (trials_.empty()) return InvalidTrial("the upload has no trials");
  return absl::OkStatus();
}

absl::StatusOr<bool> TrialTaker::BlobsExist() const {
  for (const v1::TrialInfo& trial : trials_) {
    if (batch_.HasDraft(trial.sha256())) continue;
    TACTUS_ASSIGN_OR_RETURN(const bool exists, blobs_->Has(trial.sha256()));
    if (!exists) return false;
  }
  return true;
}

absl::Status TrialTaker::Commit(uint32_t* known) {
  *known = static_cast<uint32_t>(trials_.size() - batch_.added());
  return batch_.Commit();
}

}  // namespace tactus::server
