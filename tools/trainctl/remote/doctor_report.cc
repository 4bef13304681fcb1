#include "tools/trainctl/remote/doctor_report.h"

#include <algorithm>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/text.h"
#include "tools/common/json.h"
#include "tools/trainctl/exit_code.h"

namespace tactus::internal::client {
namespace {

using Severity = CheckResult::Severity;

const char* Word(Severity severity) {
  switch (severity) {
    case Severity::kOk:
      return "ok";
    case Severity::kWarning:
      return "warning";
    default:
      return "error";
  }
}

}  // namespace

absl::Status PrintChecks(const std::vector<CheckResult>& results, bool json) {
  Json array = Json::array();
  for (const CheckResult& result : results) {
    const std::string text = Printable(result.text);
    const std::string advice = Printable(result.advice);
    if (json) {
      array.push_back({{"check", result.check},
                       {"severity", Word(result.severity)},
                       {"text", text},
                       {"advice", advice}});
      continue;
    }
    std::cout << absl::StreamFormat("%-8s %-18s %s", Word(result.severity),
                                    result.check, text);
    if (!advice.empty()) std::cout << ". To do: " << advice;
    std::cout << "\n";
  }
  if (json) std::cout << JsonText(array) << "\n";
  const auto count = [&](Severity severity) {
    return std::count_if(
        results.begin(), results.end(),
        [&](const CheckResult& result) { return result.severity == severity; });
  };
  const auto errors = count(Severity::kError);
  const auto warnings = count(Severity::kWarning);
  if (errors + warnings == 0) return absl::OkStatus();
  return WithExitCode(absl::FailedPreconditionError(absl::StrCat(
                          "errors: ", errors, ", warnings: ", warnings)),
                      errors > 0 ? kExitDoctorErrors : kExitDoctorWarnings);
}

}  // namespace tactus::internal::client
