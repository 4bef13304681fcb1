#include "server/records/pack_reader.h"

#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

namespace tactus::server {
namespace {

constexpr int64_t kLengthBytes = 4;

}  // namespace

absl::StatusOr<std::string> PackReader::Next() {
  const int64_t number = ++records_;
  if (offset_ + kLengthBytes > size_) {
    return InvalidTrial(absl::StrCat("trial number ", number,
                                     " is cut short: the pack ends within its "
                                     "length"));
  }
  TACTUS_ASSIGN_OR_RETURN(const std::string head,
                          files_.Read(path_, offset_, kLengthBytes));
  uint32_t length = 0;
  std::memcpy(&length, head.data(), sizeof length);
  if (length == 0 || length > limits::kMaxTrialRecordBytes) {
    return InvalidTrial(absl::StrCat("trial number ", number, " has ", length,
                                     " bytes; it must have 1 to ",
                                     limits::kMaxTrialRecordBytes));
  }
  if (offset_ + kLengthBytes + length > size_) {
    return InvalidTrial(absl::StrCat("trial number ", number,
                                     " is cut short: it has ", length,
                                     " bytes, but the pack ends before"));
  }
  TACTUS_ASSIGN_OR_RETURN(std::string record,
                          files_.Read(path_, offset_ + kLengthBytes, length));
  offset_ += kLengthBytes + length;
  return record;
}

}  // namespace tactus::server
