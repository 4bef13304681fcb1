#include "server/records/trial_taker.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_id.h"
#include "core/data/trial_pack.h"
#include "core/data/trial_record.h"
#include "server/records/trial_info.h"

namespace tactus::internal::server {
namespace {

// What is known of one trial: its TrialInfo, and its draft's name.
constexpr int64_t kKnownBytes = 1'024;

}  // namespace

TrialTaker::~TrialTaker() {
  if (sources_.known != nullptr) sources_.known->Return(known_ * kKnownBytes);
}

absl::Status TrialTaker::Add(absl::string_view bytes) {
  if (fault_.ok()) fault_ = Take(bytes);
  if (fault_.ok()) size_ += static_cast<int64_t>(bytes.size());
  return fault_;
}

absl::Status TrialTaker::Take(absl::string_view bytes) {
  return splitter_.Add(
      bytes, [&](uint32_t length) { return CheckRoom(length); },
      [&](const PackSplitter::Part& part) {
        if (!part.is_last()) return absl::OkStatus();
        return TakeRecord(part.record_at, part.length,
                          part.at == 0 ? part.bytes : "");
      });
}

absl::Status TrialTaker::CheckRoom(uint32_t length) {
  if (!IsRecordLength(length)) {
    return InvalidTrial(absl::StrCat(
        "trial number ", trials_.size() + 1, " has ", length,
        " bytes; it must have 1 to ", limits::kMaxTrialRecordBytes));
  }
  if (trials_.size() == limits::kMaxTrialsPerUpload) {
    return InvalidTrial(
        absl::StrCat("the upload has more than ", limits::kMaxTrialsPerUpload,
                     " trials; divide them among several datasets"));
  }
  if (sources_.known != nullptr && !sources_.known->TryTake(kKnownBytes)) {
    return WorkCancelled("the check of trials while they arrive");
  }
  ++known_;
  return absl::OkStatus();
}

absl::Status TrialTaker::TakeRecord(int64_t offset, int64_t size,
                                    absl::string_view bytes) {
  // The record, the message and the trial that are made of it, the lists of
  // both while they grow.
  const MemoryBudget::Lease lease =
      sources_.parsing->Take(3 * size + ParsedBytesAtMost(size));
  if (!bytes.empty()) return Store(bytes);
  TACTUS_ASSIGN_OR_RETURN(const std::string read, sources_.read(offset, size));
  return Store(read);
}

absl::Status TrialTaker::Store(absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(
      const v1::TrialRecord record,
      ParseTrialRecord(bytes,
                       absl::StrCat("trial number ", trials_.size() + 1)));
  if (const std::string fault = TrialIdFault(record.id()); !fault.empty()) {
    return InvalidTrial(
        absl::StrCat("trial ", Quoted(record.id()), ": id: ", fault));
  }
  if (record.has_labelling()) {
    return InvalidTrial(
        absl::StrCat("trial ", Quoted(record.id()),
                     ": labelling: only a server says who labelled a trial"));
  }
  TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
  TACTUS_ASSIGN_OR_RETURN(const std::string sha256, batch_.Add(bytes));
  trials_.push_back(InfoOf(record, trial, sha256, bytes.size()));
  return absl::OkStatus();
}

absl::Status TrialTaker::End() {
  TACTUS_RETURN_IF_ERROR(fault_);
  if (const std::string end = splitter_.EndFault(); !end.empty()) {
    return InvalidTrial(absl::StrCat("trial number ", trials_.size() + 1,
                                     " is cut short: ", end));
  }
  if (trials_.empty()) return InvalidTrial("the upload has no trials");
  return absl::OkStatus();
}

absl::StatusOr<bool> TrialTaker::BlobsExist() const {
  for (const v1::TrialInfo& trial : trials_) {
    if (batch_.HasDraft(trial.sha256())) continue;
    TACTUS_ASSIGN_OR_RETURN(const bool exists,
                            sources_.blobs->Has(trial.sha256()));
    if (!exists) return false;
  }
  return true;
}

absl::Status TrialTaker::Commit(uint32_t* known) {
  *known = static_cast<uint32_t>(trials_.size() - batch_.added());
  return batch_.Commit();
}

}  // namespace tactus::internal::server
