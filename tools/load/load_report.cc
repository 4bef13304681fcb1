#include "absl/strings/str_format.h"
#include "tools/common/json.h"
#include "tools/load/load.h"

namespace tactus::internal::client {

std::string LoadToText(const LoadReport& report) {
  std::string text = absl::StrFormat(
      "%d robots: %d messages sent, %d answered, %d lost (%d superseded)\n"
      "streams: %d refused, %d failed\n"
      "due to answer, ms: p50 %.3f  p90 %.3f  p99 %.3f  p99.9 %.3f  max %.3f\n"
      "due to sent, ms: p99 %.3f\n"
      "%.0f answers/s, %.2f processors used by the generator\n",
      report.robots, report.sent, report.answered, report.lost(),
      report.superseded, report.refused, report.failed, report.p50_ms,
      report.p90_ms, report.p99_ms, report.p999_ms, report.max_ms,
      report.send_p99_ms, report.answers_per_s, report.cpu_share);
  if (!report.first_error.empty()) {
    absl::StrAppend(&text, "first error: ", report.first_error, "\n");
  }
  return text;
}

std::string LoadToJson(const LoadReport& report) {
  const Json json = {{"robots", report.robots},
                     {"sent", report.sent},
                     {"answered", report.answered},
                     {"lost", report.lost()},
                     {"superseded", report.superseded},
                     {"refused", report.refused},
                     {"failed", report.failed},
                     {"first_error", report.first_error},
                     {"p50_ms", report.p50_ms},
                     {"p90_ms", report.p90_ms},
                     {"p99_ms", report.p99_ms},
                     {"p999_ms", report.p999_ms},
                     {"max_ms", report.max_ms},
                     {"send_p99_ms", report.send_p99_ms},
                     {"answers_per_s", report.answers_per_s},
                     {"cpu_share", report.cpu_share}};
  return JsonText(json, 1);
}

}  // namespace tactus::internal::client
