#include "core/interchange/model/model_file_error.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"

namespace tactus::internal {

absl::Status InvalidModelFile(absl::string_view path,
                              absl::string_view message) {
  return MakeError(
      absl::StatusCode::kInvalidArgument, v1::ERROR_REASON_INVALID_MODEL,
      absl::StrCat(path, ": ", message), {{"path", std::string(path)}});
}

absl::Status AsModelFileError(const absl::Status& status) {
  if (ReasonOf(status) != "TRIAL_FILE_INVALID") return status;
  return MakeError(absl::StatusCode::kInvalidArgument,
                   v1::ERROR_REASON_INVALID_MODEL, status.message());
}

}  // namespace tactus::internal
