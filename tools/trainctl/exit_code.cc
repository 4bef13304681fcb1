#include "tools/trainctl/exit_code.h"

#include <string>

#include "absl/strings/cord.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace tactus::internal::client {
namespace {

constexpr char kPayload[] = "tactus/exit-code";

}  // namespace

absl::Status WithExitCode(absl::Status status, ExitCode code) {
  status.SetPayload(kPayload, absl::Cord(absl::StrCat(static_cast<int>(code))));
  return status;
}

ExitCode ExitCodeOf(const absl::Status& status) {
  if (status.ok()) return kExitOk;
  const auto payload = status.GetPayload(kPayload);
  int code = 0;
  if (!payload && absl::StartsWith(status.message(), "--")) return kExitUsage;
  if (!payload || !absl::SimpleAtoi(std::string(*payload), &code)) {
    return kExitError;
  }
  return static_cast<ExitCode>(code);
}

}  // namespace tactus::internal::client
