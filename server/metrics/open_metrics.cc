#include "server/metrics/open_metrics.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace tactus::internal::server {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricType;

std::string Escape(absl::string_view text) {
  return absl::StrReplaceAll(text,
                             {{"\\", "\\\\"}, {"\"", "\\\""}, {"\n", "\\n"}});
}

std::string Number(double value) { return absl::StrFormat("%.17g", value); }

// The labels of a metric in braces; `more` is one in addition.
std::string LabelText(const ClientMetric& metric,
                      const std::string& more = "") {
  std::string text = absl::StrJoin(
      metric.label, ",",
      [](std::string* out, const ClientMetric::Label& label) {
        absl::StrAppend(out, label.name, "=\"", Escape(label.value), "\"");
      });
  if (!more.empty()) absl::StrAppend(&text, text.empty() ? "" : ",", more);
  return text.empty() ? "" : absl::StrCat("{", text, "}");
}

void AppendHistogram(const std::string& name, const ClientMetric& metric,
                     std::string* text) {
  const ClientMetric::Histogram& histogram = metric.histogram;
  const auto bucket = [&](const std::string& bound, uint64_t count) {
    absl::StrAppend(text, name, "_bucket",
                    LabelText(metric, absl::StrCat("le=\"", bound, "\"")), " ",
                    count, "\n");
  };
  for (const ClientMetric::Bucket& b : histogram.bucket) {
    bucket(absl::StrFormat("%g", b.upper_bound), b.cumulative_count);
  }
  bucket("+Inf", histogram.sample_count);
  absl::StrAppend(text, name, "_count", LabelText(metric), " ",
                  histogram.sample_count, "\n", name, "_sum", LabelText(metric),
                  " ", Number(histogram.sample_sum), "\n");
}

void AppendFamily(const Family& family, std::string* text) {
  const bool counts = family.type == MetricType::Counter;
  const bool spreads = family.type == MetricType::Histogram;
  const std::string name(counts ? absl::StripSuffix(family.name, "_total")
                                : absl::string_view(family.name));
  absl::StrAppend(text, "# TYPE ", name, " ",
                  counts    ? "counter"
                  : spreads ? "histogram"
                            : "gauge",
                  "\n# HELP ", name, " ", Escape(family.help), "\n");
  for (const ClientMetric& metric : family.metric) {
    if (spreads) {
      AppendHistogram(name, metric, text);
      continue;
    }
    absl::StrAppend(text, name, counts ? "_total" : "", LabelText(metric), " ",
                    Number(counts ? metric.counter.value : metric.gauge.value),
                    "\n");
  }
}

}  // namespace

std::string OpenMetricsText(const Families& families) {
  std::string text;
  for (const Family& family : families) AppendFamily(family, &text);
  return text + "# EOF\n";
}

}  // namespace tactus::internal::server
