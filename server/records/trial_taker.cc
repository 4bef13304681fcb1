#include "server/records/trial_taker.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_training.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/wire_check.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_id.h"
#include "core/data/trial_record.h"

namespace tactus::server {
namespace {

constexpr size_t kLengthBytes = 4;
// What is known of one trial: its TrialInfo, and its draft's name.
constexpr int64_t kKnownBytes = 1'024;
// A small record may take more memory than its size says.
constexpr int64_t kSlack = 64L * 1024;

uint32_t LengthOf(absl::string_view pack) {
  uint32_t length = 0;
  std::memcpy(&length, pack.data(), sizeof length);
  return length;
}

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
  return info;
}

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
  // Where `bytes` begins in the pack.
  int64_t at = size_;
  const auto skip = [&](size_t count) {
    bytes.remove_prefix(count);
    at += static_cast<int64_t>(count);
  };
  while (!bytes.empty()) {
    if (head_.size() < kLengthBytes) {
      const size_t part = std::min(kLengthBytes - head_.size(), bytes.size());
      head_.append(bytes.data(), part);
      skip(part);
      if (head_.size() == kLengthBytes) TACTUS_RETURN_IF_ERROR(CheckRoom());
      continue;
    }
    const int64_t length = LengthOf(head_);
    const auto part = static_cast<size_t>(
        std::min(length - arrived_, static_cast<int64_t>(bytes.size())));
    const bool whole = arrived_ == 0 && static_cast<int64_t>(part) == length;
    const absl::string_view record = whole ? bytes.substr(0, part) : "";
    skip(part);
    arrived_ += static_cast<int64_t>(part);
    if (arrived_ < length) break;
    TACTUS_RETURN_IF_ERROR(TakeRecord(at - length, length, record));
    head_.clear();
    arrived_ = 0;
  }
  return absl::OkStatus();
}

absl::Status TrialTaker::CheckRoom() {
  const uint32_t length = LengthOf(head_);
  if (length == 0 || length > limits::kMaxTrialRecordBytes) {
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
  const MemoryBudget::Lease lease = sources_.parsing->Take(5 * size + kSlack);
  if (!bytes.empty()) return Store(bytes);
  TACTUS_ASSIGN_OR_RETURN(const std::string read, sources_.read(offset, size));
  return Store(read);
}

absl::Status TrialTaker::Store(absl::string_view bytes) {
  const std::string name = absl::StrCat("trial number ", trials_.size() + 1);
  const WireCheck check = CheckWire(*v1::TrialRecord::descriptor(), bytes);
  if (!check.fault.empty()) {
    return InvalidTrial(
        absl::StrCat(name, " is not a tactus.v1.TrialRecord: ", check.fault));
  }
  const auto most = 2 * static_cast<int64_t>(bytes.size()) + kSlack;
  if (check.parsed_bytes > most) {
    return InvalidTrial(absl::StrCat(name, " has ", bytes.size(),
                                     " bytes and takes ", check.parsed_bytes,
                                     " bytes of memory; it may take ", most));
  }
  v1::TrialRecord record;
  if (!record.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return InvalidTrial(absl::StrCat(
        name, " is not a tactus.v1.TrialRecord: a text in it is not UTF-8"));
  }
  if (const std::string fault = TrialIdFault(record.id()); !fault.empty()) {
    return InvalidTrial(
        absl::StrCat("trial ", Quoted(record.id()), ": id: ", fault));
  }
  TACTUS_ASSIGN_OR_RETURN(const Trial trial, FromRecord(record));
  TACTUS_ASSIGN_OR_RETURN(const std::string sha256, batch_.Add(bytes));
  trials_.push_back(InfoOf(record, trial, sha256, bytes.size()));
  return absl::OkStatus();
}

absl::Status TrialTaker::End() {
  TACTUS_RETURN_IF_ERROR(fault_);
  if (!head_.empty()) {
    const std::string end =
        head_.size() < kLengthBytes
            ? "the pack ends within its length"
            : absl::StrCat("it has ", LengthOf(head_),
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

}  // namespace tactus::server
