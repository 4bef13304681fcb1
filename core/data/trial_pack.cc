#include "core/data/trial_pack.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/data/trial_record.h"

namespace tactus::internal {
namespace {

constexpr size_t kLengthBytes = 4;

uint32_t LengthOf(absl::string_view head) {
  uint32_t length = 0;
  for (size_t i = 0; i < kLengthBytes; ++i) {
    length |= uint32_t{static_cast<uint8_t>(head[i])} << (8 * i);
  }
  return length;
}

}  // namespace

bool IsRecordLength(int64_t length) {
  return length > 0 && length <= limits::kMaxTrialRecordBytes;
}

absl::Status AppendToPack(const v1::TrialRecord& record, std::string* pack) {
  const size_t length = record.ByteSizeLong();
  if (!IsRecordLength(static_cast<int64_t>(length))) {
    return InvalidTrial(absl::StrCat("trial ", Quoted(record.id()), " has ",
                                     length, " bytes; it must have 1 to ",
                                     limits::kMaxTrialRecordBytes));
  }
  for (size_t i = 0; i < kLengthBytes; ++i) {
    pack->push_back(static_cast<char>(length >> (8 * i)));
  }
  record.AppendToString(pack);
  return absl::OkStatus();
}

absl::Status PackSplitter::Add(
    absl::string_view bytes, absl::FunctionRef<absl::Status(uint32_t)> begin,
    absl::FunctionRef<absl::Status(const Part&)> take) {
  const auto next = [&](size_t most) {
    const absl::string_view part = bytes.substr(0, most);
    bytes.remove_prefix(part.size());
    taken_ += static_cast<int64_t>(part.size());
    return part;
  };
  while (!bytes.empty()) {
    if (head_.size() < kLengthBytes) {
      absl::StrAppend(&head_, next(kLengthBytes - head_.size()));
      if (head_.size() < kLengthBytes) break;
      TACTUS_RETURN_IF_ERROR(begin(LengthOf(head_)));
      continue;
    }
    const int64_t length = LengthOf(head_);
    const absl::string_view part = next(static_cast<size_t>(length - arrived_));
    const int64_t at = arrived_;
    arrived_ += static_cast<int64_t>(part.size());
    const Part taken = {part, at, taken_ - arrived_, length};
    if (taken.is_last()) {
      head_.clear();
      arrived_ = 0;
    }
    TACTUS_RETURN_IF_ERROR(take(taken));
  }
  return absl::OkStatus();
}

std::string PackSplitter::EndFault() const {
  if (head_.empty()) return "";
  if (head_.size() < kLengthBytes) return "the pack ends within its length";
  return absl::StrCat("it has ", LengthOf(head_),
                      " bytes, but the pack ends before");
}

absl::Status TrialUnpacker::Add(absl::string_view bytes) {
  return splitter_.Add(
      bytes,
      [&](uint32_t length) {
        if (IsRecordLength(length)) return absl::OkStatus();
        return InvalidResponse(
            absl::StrCat("length of record ", records_), length,
            absl::StrCat("1 to ", limits::kMaxTrialRecordBytes));
      },
      [&](const PackSplitter::Part& part) { return Take(part); });
}

absl::Status TrialUnpacker::Take(const PackSplitter::Part& part) {
  const bool whole = part.at == 0 && part.is_last();
  if (!whole) absl::StrAppend(&pending_, part.bytes);
  if (!part.is_last()) return absl::OkStatus();
  const auto record =
      ParseTrialRecord(whole ? part.bytes : absl::string_view(pending_),
                       absl::StrCat("record ", records_));
  pending_.clear();
  if (!record.ok()) {
    return InvalidResponse("the trial pack", record.status().message(),
                           "tactus.v1.TrialRecords");
  }
  ++records_;
  return sink_(*record);
}

absl::Status TrialUnpacker::Finish() const {
  const std::string fault = splitter_.EndFault();
  if (fault.empty()) return absl::OkStatus();
  return InvalidResponse("end of the trial pack",
                         absl::StrCat("within record ", records_, ": ", fault),
                         "behind a record");
}

}  // namespace tactus::internal
