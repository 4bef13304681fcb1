#include "absl/strings/str_format.h"
#include "tools/common/json.h"
#include "tools/load/load.h"

namespace tactus::internal::client {

namespace {

std::string FinalText(const LoadReport& report) {
  if (report.final_p50_ms == 0) return "";
  return absl::StrFormat("end to last answer, ms: p50 %.3f\n",
                         report.final_p50_ms);
}

std::string SlowText(const LoadReport& report) {
  if (report.slow_superseded == 0) return "";
  return absl::StrFormat("slow readers: %d answers superseded\n",
                         report.slow_superseded);
}

}  // namespace

std::string LoadToText(const LoadReport& report) {
  std::string text = absl::StrFormat(
      "%d robots: %d messages sent, %d answered, %d lost\n"
      "answers: %d came, %d superseded, %d touches unreported\n"
      "streams: %d opened, %d refused, %d failed\n"
      "due to answer, ms: p50 %.3f  p90 %.3f  p99 %.3f  p99.9 %.3f  max %.3f\n"
      "due to sent, ms: p99 %.3f\n"
      "%s%s%.0f answers/s, %.2f processors used by the generator\n",
      report.robots, report.sent, report.answered, report.lost(),
      report.answers, report.superseded, report.unannounced, report.streams,
      report.refused, report.failed, report.p50_ms, report.p90_ms,
      report.p99_ms, report.p999_ms, report.max_ms, report.send_p99_ms,
      FinalText(report), SlowText(report), report.answers_per_s,
      report.cpu_share);
  if (!report.first_error.empty()) {
    absl::StrAppend(&text, "first error: ", report.first_error, "\n");
  }
  return text;
}

std::string LoadToJson(const LoadReport& report,
                       std::optional<int> max_robots) {
  Json json = {{"robots", report.robots},
               {"sent", report.sent},
               {"answered", report.answered},
               {"lost", report.lost()},
               {"answers", report.answers},
               {"superseded", report.superseded},
               {"unannounced", report.unannounced},
               {"slow_superseded", report.slow_superseded},
               {"streams", report.streams},
               {"refused", report.refused},
               {"failed", report.failed},
               {"first_error", report.first_error},
               {"p50_ms", report.p50_ms},
               {"p90_ms", report.p90_ms},
               {"p99_ms", report.p99_ms},
               {"p999_ms", report.p999_ms},
               {"max_ms", report.max_ms},
               {"send_p99_ms", report.send_p99_ms},
               {"final_p50_ms", report.final_p50_ms},
               {"answers_per_s", report.answers_per_s},
               {"cpu_share", report.cpu_share}};
  if (max_robots) json["max_robots"] = *max_robots;
  return JsonText(json, 1);
}

}  // namespace tactus::internal::client
