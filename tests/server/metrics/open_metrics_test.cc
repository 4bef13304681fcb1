#include "server/metrics/open_metrics.h"

#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

// Written out by hand from the examples of the OpenMetrics specification;
// tests/server/metrics/metrics_check.py reads a server's with another parser.
TEST(OpenMetricsTest, WritesCountersGaugesAndHistograms) {
  Family counter = CounterFamily("a_total", "What \"a\" is.\nMore.");
  Add({{"k", "v\"\\\n"}}, 3, &counter);
  Family gauge = GaugeFamily("g", "G.");
  Add({}, 0.25, &gauge);
  constexpr std::array kBounds = {0.5, 1.0};
  Histogram histogram(kBounds);
  histogram.Observe(0.75, 2);
  Family spread = HistogramFamily("h", "H.");
  Add({{"k", "v"}}, histogram.Read(), kBounds, &spread);
  EXPECT_EQ(OpenMetricsText({counter, gauge, spread}),
            "# TYPE a counter\n"
            "# HELP a What \\\"a\\\" is.\\nMore.\n"
            "a_total{k=\"v\\\"\\\\\\n\"} 3\n"
            "# TYPE g gauge\n"
            "# HELP g G.\n"
            "g 0.25\n"
            "# TYPE h histogram\n"
            "# HELP h H.\n"
            "h_bucket{k=\"v\",le=\"0.5\"} 0\n"
            "h_bucket{k=\"v\",le=\"1\"} 2\n"
            "h_bucket{k=\"v\",le=\"+Inf\"} 2\n"
            "h_count{k=\"v\"} 2\n"
            "h_sum{k=\"v\"} 1.5\n"
            "# EOF\n");
}

}  // namespace
}  // namespace tactus::internal::server
