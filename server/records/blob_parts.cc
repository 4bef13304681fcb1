#include "server/records/blob_parts.h"

#include <algorithm>
#include <string>

#include "absl/strings/escaping.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"

namespace tactus::internal::server {
namespace {

constexpr int64_t kPartBytes = 1024L * 1024;

}  // namespace

absl::Status ReadBlobParts(
    const DataDirectory& data, absl::string_view sha256, int64_t limit,
    absl::FunctionRef<absl::Status(absl::string_view)> take) {
  const std::string path = data.blobs().PathOf(sha256);
  TACTUS_ASSIGN_OR_RETURN(const int64_t size, data.files().Size(path));
  if (size <= kPartBytes) {
    TACTUS_ASSIGN_OR_RETURN(
        const std::string bytes,
        data.blobs().Read(std::string(sha256), std::min(limit, kPartBytes)));
    return take(bytes);
  }
  // The blob store words the error of a blob that is damaged or too large.
  const auto damage = [&]() -> absl::Status {
    const absl::Status whole =
        data.blobs().Read(std::string(sha256), limit).status();
    return whole.ok() ? DataLost(path, "it changed while it was read") : whole;
  };
  if (size > limit) return damage();
  const auto each_part =
      [&](absl::FunctionRef<absl::Status(absl::string_view)> use)
      -> absl::Status {
    for (int64_t at = 0; at < size; at += kPartBytes) {
      TACTUS_ASSIGN_OR_RETURN(
          const std::string part,
          data.files().Read(path, at, std::min(kPartBytes, size - at)));
      TACTUS_RETURN_IF_ERROR(use(part));
    }
    return absl::OkStatus();
  };
  Sha256 digest;
  TACTUS_RETURN_IF_ERROR(each_part([&](absl::string_view part) {
    digest.Add(part);
    return absl::OkStatus();
  }));
  if (absl::BytesToHexString(digest.Finish()) != sha256) {
    return damage();
  }
  return each_part(take);
}

}  // namespace tactus::internal::server
