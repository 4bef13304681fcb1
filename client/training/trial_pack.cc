#include "client/training/trial_pack.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::client {
namespace {

constexpr size_t kLengthBytes = 4;
constexpr uint32_t kMaxRecordBytes = std::numeric_limits<int32_t>::max();

uint32_t LengthOf(absl::string_view pack) {
  uint32_t length = 0;
  for (size_t i = 0; i < kLengthBytes; ++i) {
    length |= uint32_t{static_cast<uint8_t>(pack[i])} << (8 * i);
  }
  return length;
}

}  // namespace

absl::Status AppendToPack(const v1::TrialRecord& record, std::string* pack) {
  const size_t length = record.ByteSizeLong();
  if (length > kMaxRecordBytes) {
    return InvalidTrial(absl::StrCat("trial ", Quoted(record.id()), " has ",
                                     length, " bytes; it must have at most ",
                                     kMaxRecordBytes));
  }
  for (size_t i = 0; i < kLengthBytes; ++i) {
    pack->push_back(static_cast<char>(length >> (8 * i)));
  }
  record.AppendToString(pack);
  return absl::OkStatus();
}

absl::Status TrialUnpacker::Add(absl::string_view bytes) {
  while (!bytes.empty()) {
    const size_t want = pending_.size() < kLengthBytes
                            ? kLengthBytes
                            : kLengthBytes + LengthOf(pending_);
    const size_t taken = std::min(want - pending_.size(), bytes.size());
    pending_.append(bytes.data(), taken);
    bytes.remove_prefix(taken);
    if (pending_.size() < kLengthBytes) break;
    const uint32_t length = LengthOf(pending_);
    if (length == 0 || length > kMaxRecordBytes) {
      return InvalidResponse(absl::StrCat("length of record ", records_),
                             length, absl::StrCat("1 to ", kMaxRecordBytes));
    }
    if (pending_.size() < kLengthBytes + length) continue;
    v1::TrialRecord record;
    if (!record.ParseFromArray(pending_.data() + kLengthBytes,
                               static_cast<int>(length))) {
      return InvalidResponse(absl::StrCat("record ", records_),
                             "no TrialRecord", "a serialized TrialRecord");
    }
    ++records_;
    pending_.clear();
    TACTUS_RETURN_IF_ERROR(sink_(record));
  }
  return absl::OkStatus();
}

absl::Status TrialUnpacker::Finish() const {
  if (pending_.empty()) return absl::OkStatus();
  return InvalidResponse("end of the trial pack",
                         absl::StrCat("within record ", records_),
                         "behind a record");
}

}  // namespace tactus::client
