#include "tools/load/load_tally.h"

#include <algorithm>

namespace tactus::internal::client {
namespace {

double Ms(const LatencyHistogram& histogram, double fraction) {
  return static_cast<double>(histogram.PercentileNs(fraction)) / 1e6;
}

}  // namespace

void LoadTally::Add(const LoadTally& other) {
  robots += other.robots;
  sent += other.sent;
  answered += other.answered;
  answers += other.answers;
  superseded += other.superseded;
  unannounced += other.unannounced;
  refused += other.refused;
  failed += other.failed;
  if (first_error.empty()) first_error = other.first_error;
  answer_delay.Add(other.answer_delay);
  send_delay.Add(other.send_delay);
  final_delay.Add(other.final_delay);
  elapsed_s = std::max(elapsed_s, other.elapsed_s);
  cpu_s += other.cpu_s;
}

LoadReport ReportOf(const LoadTally& tally) {
  const double elapsed_s = std::max(tally.elapsed_s, 1e-9);
  return {.robots = tally.robots,
          .sent = tally.sent,
          .answered = tally.answered,
          .answers = tally.answers,
          .superseded = tally.superseded,
          .unannounced = tally.unannounced,
          .refused = tally.refused,
          .failed = tally.failed,
          .first_error = tally.first_error,
          .p50_ms = Ms(tally.answer_delay, 0.5),
          .p90_ms = Ms(tally.answer_delay, 0.9),
          .p99_ms = Ms(tally.answer_delay, 0.99),
          .p999_ms = Ms(tally.answer_delay, 0.999),
          .max_ms = Ms(tally.answer_delay, 1),
          .send_p99_ms = Ms(tally.send_delay, 0.99),
          .final_p50_ms = Ms(tally.final_delay, 0.5),
          .answers_per_s = static_cast<double>(tally.answers) / elapsed_s,
          .cpu_share = tally.cpu_s / elapsed_s};
}

}  // namespace tactus::internal::client
